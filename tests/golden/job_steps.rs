//! Jumps of a slave at cam changes and cam starts in jobs, and waiting for a probe's trigger.

use crate::desk::{Desk, Done};

/// From rest to 0.8 mm/mm, and from there to rest; both begin at 0.
const CAMS: [(&str, &str); 2] = [
    ("out.toml", "{ master = 0, slave = 0 }, { from = [50, 20], to = [100, 60] }"),
    ("back.toml", "{ from = [0, 0], to = [30, 24] }, { master = 100, slave = 40 }"),
];

fn check(blocks: &str) -> Done {
    let desk = Desk::new();
    for (name, elements) in CAMS {
        let text = format!(
            "name = \"{name}\"\nmaster = {{ min = 0, max = 100, unit = \"mm\" }}\n\
             slave = {{ min = 0, max = 60, unit = \"mm\" }}\nelements = [{elements}]\n"
        );
        desk.write(name, &text);
    }
    desk.write("job.toml", blocks);
    desk.twin("check job.toml --machine machine.toml")
}

/// The master is 40 mm/s · 1 ms beyond the end of the first cam where the second one is laid upon it: what it has gone too far
/// is lost, and the slave stands for a part of a cycle.
#[test]
fn a_slave_that_stands_between_two_cams_is_told() {
    let done = check(
        r#"
duration_s = 3.5
[[start]]
axis = "X"
position_mm = 0
[[start]]
axis = "Y"
position_mm = 0

[[blocks]]
block = "MC_MoveVelocity"
axis = "Y"
velocity_mm_per_s = 40.03
acceleration_mm_per_s2 = 500

[[blocks]]
block = "MC_CamIn"
axis = "X"
master = "Y"
cam = "out.toml"
periodic = false
master_absolute = false
with_previous = true

[[blocks]]
block = "MC_CamIn"
axis = "X"
master = "Y"
cam = "back.toml"
periodic = false
start_mode = "relative"
master_absolute = false
at_end_of_profile = true
"#,
    );
    // The block that lays it there.
    done.ended(1, "line 26: axis X: acceleration");
}

/// An absolute start where the slave is not is a step of the slave, by the block that starts it.
#[test]
fn a_cam_that_its_slave_jumps_onto_is_told_at_its_block() {
    let done = check(
        r#"
[[start]]
axis = "X"
position_mm = 30
[[start]]
axis = "Y"
position_mm = 10

[[blocks]]
block = "MC_MoveAbsolute"
axis = "Y"
position_mm = 95
velocity_mm_per_s = 40
acceleration_mm_per_s2 = 500

[[blocks]]
block = "MC_CamIn"
axis = "X"
master = "Y"
cam = "out.toml"
periodic = false
start_mode = "absolute"
at_s = 0.5005
"#,
    );
    done.ended(1, "line 17: MC_CamIn: the cam wants X at");
    assert!(!done.stderr.contains("line 10: axis X"), "{}", done.stderr);
}

/// The probe's trigger comes when all has stood for seconds.
#[test]
fn a_probe_waits_for_its_trigger() {
    let job = r#"
[[start]]
axis = "X"
position_mm = 0

[[triggers]]
name = "edge"
at_s = 5.0

[[blocks]]
block = "MC_TouchProbe"
axis = "X"
trigger = "edge"

[[blocks]]
block = "MC_MoveAbsolute"
axis = "X"
position_mm = 50
velocity_mm_per_s = 50
with_previous = true
"#;
    check(job).ended(0, "");
    let never = job.replace("at_s = 5.0", "axis = \"X\"\nposition_mm = 60.0");
    check(&never).ended(1, "MC_TouchProbe waits for ever");
}
