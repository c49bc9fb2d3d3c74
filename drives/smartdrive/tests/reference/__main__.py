"""A second reading of "SmartDRIVE v1.2 - Protocole série ATB", made of tables, to witness for the first.

    python3 -B reference master PORT [PART ...]   asks the module on PORT everything the manual has, or parts of it, and
                                                  checks what it says; "echo" is a wire that repeats what is said
    python3 -B reference device                   is a module on a terminal of its own, which it names, until its input ends

The master says on its standard output what it wants done at the module ("press LIMP") and waits for a line;
the device takes such lines on its standard input and answers each with one.
Standard library only.
"""

import sys

import device
import master

if sys.argv[1] == "device":
    device.Device().run()
else:
    _, _, path, *parts = sys.argv
    names = [part for part in parts if part != "echo"]
    master.ask(path, "echo" in parts, names)
