"""A second reading of the BIM2AX-BOCM manual (rev. D), made of tables, to witness for the first.

    python3 -B reference host FILE     drives the module on a memory file through everything the manual has and checks
                                       what it says
    python3 -B reference module FILE   is a module on a memory file until its standard input ends

The host says on its standard output what it wants done at the module ("power 1 off") and waits for a line.
Standard library only.
"""

import sys

import host
import module

if sys.argv[1] == "module":
    module.Module(sys.argv[2]).run()
else:
    host.drive(sys.argv[2])
