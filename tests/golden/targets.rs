//! Protection of input files: no command writes over a file that it reads.

use crate::process::Desk;

#[test]
fn what_is_read_is_not_written_over() {
    let desk = Desk::new();
    desk.write("short.cnc", "% short\nN10 G1 X10 F100 E500 E-500\nN20 G1 X0\n");
    desk.write("faults.toml", "[[faults]]\nkind = \"jam\"\naxis = \"Z\"\nat_s = 9.0\n");
    let files = ["machine.toml", "short.cnc", "faults.toml"];
    let text = |name: &str| std::fs::read_to_string(desk.path(name)).expect("it is there");
    let before = files.map(text);
    let run = ["run", "short.cnc", "-m", "machine.toml", "--drives", "none"];
    let machine = ["machine", "machine.toml"];
    let path = ["path", "short.cnc", "--format", "jsonl", "--machine", "machine.toml"];
    let cases: [(&[&str], &[&str]); 9] = [
        (&run, &["--record", "machine.toml"]),
        (&run, &["--report", "./machine.toml"]),
        (&run, &["--record", "short.cnc"]),
        (&run, &["--report", "short.cnc"]),
        (&run, &["--faults", "faults.toml", "--record", "faults.toml"]),
        (&run, &["--report", "both.out", "--record", "both.out"]),
        (&machine, &["--svg", "machine.toml"]),
        (&machine, &["--record", "machine.toml"]),
        (&path, &["-o", "machine.toml"]),
    ];
    for (command, more) in cases {
        let arguments: Vec<_> = command.iter().chain(more).copied().collect();
        desk.twin(&arguments).ended(2, "name another file");
        assert_eq!(files.map(text), before, "{arguments:?}");
    }
}
