//! Protection of input files: no command writes over a file that it reads.

use crate::desk::Desk;

#[test]
fn what_is_read_is_not_written_over() {
    let desk = Desk::new();
    desk.write("short.cnc", "% short\nN10 G1 X10 F100 E500 E-500\nN20 G1 X0\n");
    desk.write("faults.toml", "[[faults]]\nkind = \"jam\"\naxis = \"Z\"\nat_s = 9.0\n");
    let files = ["machine.toml", "short.cnc", "faults.toml"];
    let text = |name: &str| desk.text(name);
    let before = files.map(text);
    let run = "run short.cnc -m machine.toml --drives none";
    let path = "path short.cnc --format jsonl --machine machine.toml";
    let cases = [
        (run, "--record machine.toml"),
        (run, "--report ./machine.toml"),
        (run, "--record short.cnc"),
        (run, "--report short.cnc"),
        (run, "--faults faults.toml --record faults.toml"),
        (run, "--report both.out --record both.out"),
        ("machine machine.toml", "--svg machine.toml"),
        ("machine machine.toml", "--record machine.toml"),
        (path, "-o machine.toml"),
    ];
    for (command, more) in cases {
        desk.twin(&format!("{command} {more}")).ended(2, "name another file");
        assert_eq!(files.map(text), before, "{command} {more}");
    }
}
