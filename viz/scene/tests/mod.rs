//! Tests that read recordings back with rerun's decoder; expectations are the inputs in other units.

mod clearance;
mod motors;
pub(crate) mod read;

use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use rerun::components;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use twin_urdf::{Joint, JointDrive, JointKind, Link, Mesh, Solid, SolidShape, Tip};

use super::*;
use crate::frame::{AxisUnit, MoveKind};
use read::Read;

pub(crate) fn machine() -> Model {
    let link = |name: &str, solids| Link::new(name, None, solids);
    let (origin, color) = (Isometry3::translation(0.0, 0.0, 0.01), [1.0, 0.5, 0.0, 1.0]);
    let solid = |shape| Solid { shape, origin, color };
    let base = vec![solid(SolidShape::Box { size: Vector3::new(0.1, 0.2, 0.3) })];
    let arm =
        [SolidShape::Cylinder { radius: 0.02, length: 0.4 }, SolidShape::Sphere { radius: 0.03 }];
    let (still, axis) = (Isometry3::identity(), JointDrive::Axis(0));
    let joint = Joint::new("A", JointKind::Revolute, [0, 1], still, Vector3::z_axis(), axis);
    Model {
        name: "one arm".to_owned(),
        links: vec![link("base", base), link("arm 1", arm.map(solid).into())],
        joints: vec![joint],
        loops: Vec::new(),
        tip: Tip { link: 1, point: Point3::new(0.4, 0.0, 0.0) },
    }
}

/// A box that is turned a quarter about z, in which something can be seen.
pub(crate) fn fixed_jaw() -> Vec<Solid> {
    let shape = SolidShape::Box { size: Vector3::new(0.2, 0.1, 0.05) };
    let origin = Isometry3::from_parts(Translation3::new(2.0, 0.0, -0.4), quarter_turn());
    vec![Solid { shape, origin, color: [0.0, 0.5, 1.0, 0.6] }]
}

fn axes() -> Vec<Axis> {
    let axis = |(name, unit): (&str, _)| Axis { name: name.to_owned(), unit };
    [("A", AxisUnit::Rotary), ("Z", AxisUnit::Linear)].map(axis).into()
}

fn open(options: &SceneOptions) -> Result<Scene, VizError> {
    open_measured(options, &machine(), None)
}

fn open_measured(
    options: &SceneOptions,
    machine: &Model,
    clearance: Option<f64>,
) -> Result<Scene, VizError> {
    let setup = Setup {
        machine,
        home: &[Isometry3::identity(); 2],
        surroundings: &[Obstacle { name: "fixed jaw", solids: &fixed_jaw() }],
        bodies: &[],
        clearance,
        axes: &axes(),
        program: Program { name: "part.cnc", text: "%\nN10 G0 X10\nN20 G1 X20 F5\n" },
        drives: None,
    };
    Scene::open(options, &setup)
}

fn open_file(path: &Path) -> Scene {
    open(&SceneOptions { record: Some(path.to_owned()), ..SceneOptions::default() }).unwrap()
}

/// The tool goes 1 µm per ms along x; the twin is 2 µm, the drives are 3 µm behind. Lines change every 10 ms.
fn log_ms(scene: &mut Scene, ms: u32, has_drives: bool) {
    let (x, angle) = (f64::from(ms) * 1e-6, f64::from(ms).to_radians() * 1e-3);
    let at = |x| Point3::new(x, 0.0, 0.5);
    let arm = Isometry3::from_parts(Translation3::new(x, 0.0, 0.0), quarter_turn());
    let (twin_errors, drive_errors) = ([angle, 5e-6], [-angle, 0.0]);
    let behind = |x, axis_errors| Deviation { tool: at(x), tool_error: 2e-6, axis_errors };
    let deviation = Deviation { tool_error: 3e-6, ..behind(x - 3e-6, &drive_errors) };
    let link_poses = [Isometry3::identity(), arm];
    let frame = Frame {
        setpoint: at(x),
        path_speed: 1e-3,
        twin: behind(x - 2e-6, &twin_errors),
        drives: has_drives.then_some(DrivesFrame { deviation, tool_error_to_twin: 1e-6 }),
        ..still(ms, &link_poses)
    };
    scene.frame(&frame).unwrap();
}

/// A small real recording, for other tests.
pub(crate) fn record_three_frames(path: &Path) {
    let mut scene = open_file(path);
    (0..3).for_each(|ms| log_ms(&mut scene, ms, false));
    assert!(scene.finish().unwrap().is_none());
}

fn record(milliseconds: u32, has_drives: bool) -> Read {
    use MoveKind::{Cut, Prepared, Rapid};
    let strips = [(Cut, 0.25), (Rapid, 0.5), (Cut, 1.0), (Prepared, 2.0)].map(|(kind, x)| {
        PathStrip { kind, points: vec![Point3::origin(), Point3::new(x, 0.0, 0.0)] }
    });
    written(|scene| {
        scene.programmed_path(&strips).unwrap();
        (0..milliseconds).for_each(|ms| log_ms(scene, ms, has_drives));
    })
}

/// The recording into which `write` has written.
fn written(write: impl FnOnce(&mut Scene)) -> Read {
    written_of(&machine(), None, write)
}

/// The same of any machine, whose clearance may be measured.
fn written_of(machine: &Model, clearance: Option<f64>, write: impl FnOnce(&mut Scene)) -> Read {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.rrd");
    let options = SceneOptions { record: Some(path.clone()), ..SceneOptions::default() };
    let mut scene = open_measured(&options, machine, clearance).unwrap();
    write(&mut scene);
    scene.finish().unwrap();
    Read::new(&path)
}

/// A machine that rests, of which nothing more is known.
fn still(ms: u32, link_poses: &[Isometry3<f64>]) -> Frame<'_> {
    Frame {
        time_ns: i64::from(ms) * 1_000_000,
        line: 1 + ms / 10,
        setpoint: Point3::origin(),
        path_speed: 0.0,
        programmed_speed: None,
        link_poses,
        body_poses: &[],
        twin: Deviation { tool: Point3::origin(), tool_error: 0.0, axis_errors: &[0.0; 2] },
        motors: &[],
        clearance: None,
        drives: None,
    }
}

#[track_caller]
fn assert_miscounted(error: &VizError, of: &str, [wanted, given]: [usize; 2]) {
    let VizError::Count { what, expected, found, .. } = error else { panic!("{error:?}") };
    assert_eq!((*what, *expected, *found), (of, wanted, given));
}

fn seconds(time_ns: i64) -> f64 {
    f64::from(i32::try_from(time_ns / 1000).unwrap()) * 1e-6
}

fn assert_near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-9, "{found} is not {wanted}");
}

fn quarter_turn() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2)
}

const QUARTER_TURN: [f32; 4] =
    [0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2];

#[track_caller]
fn assert_close<const N: usize>(found: [f32; N], wanted: [f32; N]) {
    let near = found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6);
    assert!(near, "{found:?} is not {wanted:?}");
}

/// Asserts that a plot has as many values, one each ms at its time and line, as `wanted` makes of the ms.
fn assert_plot(read: &Read, entity: &str, count: usize, wanted: impl Fn(f64) -> f64) {
    let rows = read.scalars(entity);
    assert_eq!(rows.len(), count, "{entity}");
    for (ms, (time_ns, line, value)) in (0_u32..).zip(rows) {
        let at = (i64::from(ms) * 1_000_000, i64::from(1 + ms / 10));
        assert_eq!((time_ns, line), at, "{entity}");
        assert_near(value, wanted(f64::from(ms)));
    }
}

#[test]
fn every_error_comes_back_in_mm_and_degrees_at_its_time_and_line() {
    let read = record(25, true);
    for (entity, wanted, more) in [
        ("error/tool/twin", 2e-3, 0.0),
        ("error/tool/drives", 3e-3, 0.0),
        ("error/tool/between", 1e-3, 0.0),
        ("speed/set-point", 1.0, 0.0),
        ("error/axis_deg/A/twin", 0.0, 1e-3),
        ("error/axis_deg/A/drives", 0.0, -1e-3),
        ("error/axis_mm/Z/twin", 5e-3, 0.0),
    ] {
        assert_plot(&read, entity, 25, |ms| wanted + more * ms);
    }
    assert_eq!(read.scalars("speed/programmed"), []);
}

#[test]
fn lines_in_plots_are_named_before_they_have_values() {
    let read = record(3, true);
    for (entity, name) in [
        ("error/tool/twin", "twin to set-point"),
        ("error/axis_deg/A/drives", "A drives (°)"),
        ("error/axis_mm/Z/twin", "Z twin (mm)"),
    ] {
        assert_eq!(read.names(entity), [name]);
        assert!(read.of(entity).next().unwrap().is_static(), "{entity}");
    }
}

#[test]
fn the_machine_moves_fifty_times_a_second_in_mm() {
    let read = record(45, false);
    let poses = read.places("machine/arm 1");
    // The home pose and that of the first frame share the time 0.
    let places: Vec<_> = poses.iter().map(|(time, line, _)| (*time / 1_000_000, *line)).collect();
    assert_eq!(places, [(0, 0), (0, 1), (20, 3), (40, 5)]);
    assert_close(poses[3].2[0].0.0, [0.04, 0.0, 0.0]);
    let quaternion = rerun::Transform3D::descriptor_quaternion();
    let turns = read.rows::<components::RotationQuat>("machine/arm 1", &quaternion);
    assert_close(turns[3].2[0].0.xyzw(), QUARTER_TURN);
}

#[test]
fn drives_that_answer_now_and_then_are_shown_whenever_they_do() {
    // The drives answer each 25 ms, the first time at 5 ms: never when a pose of the machine is due.
    let read = written(|scene| (0..100).for_each(|ms| log_ms(scene, ms, ms % 25 == 5)));
    let markers = read.places("tool/drives");
    let times: Vec<_> = markers.iter().map(|(time_ns, ..)| time_ns / 1_000_000).collect();
    assert_eq!(times, [5, 30, 55, 80]);
    assert_eq!(read.scalars("error/tool/drives").len(), 4);
}

#[test]
fn solids_are_logged_once_in_mm() {
    let read = record(1, false);
    let half = |size: components::HalfSize3D| size.0.0;
    let sizes = rerun::Boxes3D::descriptor_half_sizes();
    assert_eq!(read.each("machine/base/boxes", &sizes, half), [[50.0, 100.0, 150.0]]);
    let arm = "machine/arm 1/cylinders";
    let lengths = rerun::Cylinders3D::descriptor_lengths();
    assert_eq!(read.each(arm, &lengths, |length: components::Length| length.0.0), [400.0]);
    let centers = rerun::Cylinders3D::descriptor_centers();
    let centers = read.each(arm, &centers, |center: components::Translation3D| center.0.0);
    assert_eq!(centers, [[0.0, 0.0, 10.0]]);
    let colors = read.statics::<components::Color>(arm, &rerun::Cylinders3D::descriptor_colors());
    assert_eq!(colors[0].to_array(), [255, 128, 0, 255]);
    let sizes = rerun::Ellipsoids3D::descriptor_half_sizes();
    assert_eq!(read.each("machine/arm 1/spheres", &sizes, half), [[30.0; 3]]);
}

/// A mesh in mm, in the frame of its link, seen from outside; a capsule from its lower end.
#[test]
fn meshes_and_capsules_are_logged_in_mm() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = Mesh::new("corner.stl", corners.map(Point3::from).into(), triangles).unwrap();
    let scale = Vector3::new(0.1, -0.2, 0.3);
    let mut machine = machine();
    let shape = SolidShape::Mesh { mesh: mesh.into(), scale };
    let origin = Isometry3::translation(0.0, 0.0, 0.5);
    machine.links[0].solids.push(Solid { shape, origin, color: [1.0, 0.0, 0.0, 1.0] });
    let shape = SolidShape::Capsule { radius: 0.02, length: 0.3 };
    machine.links[1].solids.push(Solid { shape, origin, color: [1.0; 4] });
    let read = written_of(&machine, None, |_| {});
    let entity = "machine/base/mesh1";
    let positions = rerun::Mesh3D::descriptor_vertex_positions();
    let places = read.each(entity, &positions, |place: components::Position3D| place.0.0);
    assert_eq!(places.len(), 12);
    let expected =
        [[0.0, 0.0, 500.0], [100.0, 0.0, 500.0], [0.0, -200.0, 500.0], [0.0, 0.0, 800.0]];
    assert!(places.iter().all(|place| expected.contains(place)), "{places:?}");
    // The normal of the side below: down.
    let normals = rerun::Mesh3D::descriptor_vertex_normals();
    let normals = read.each(entity, &normals, |normal: components::Vector3D| normal.0.0);
    assert_eq!(normals[..1], [[0.0, 0.0, -1.0]]);
    let factor = rerun::Mesh3D::descriptor_albedo_factor();
    let factor = read.statics::<components::AlbedoFactor>(entity, &factor);
    assert_eq!(factor[0].0.to_array(), [255, 0, 0, 255]);
    let entity = "machine/arm 1/capsules";
    let translations = rerun::Capsules3D::descriptor_translations();
    let below = read.each(entity, &translations, |place: components::Translation3D| place.0.0);
    assert_eq!(below, [[0.0, 0.0, 350.0]]);
    let lengths = rerun::Capsules3D::descriptor_lengths();
    assert_eq!(read.each(entity, &lengths, |length: components::Length| length.0.0), [300.0]);
}

#[test]
fn obstacles_are_next_to_the_machine() {
    let read = record(1, false);
    let entity = "surroundings/fixed jaw/boxes";
    let sizes = rerun::Boxes3D::descriptor_half_sizes();
    let sizes = read.each(entity, &sizes, |size: components::HalfSize3D| size.0.0);
    assert_eq!(sizes, [[100.0, 50.0, 25.0]]);
    let centers = rerun::Boxes3D::descriptor_centers();
    let centers = read.each(entity, &centers, |center: components::Translation3D| center.0.0);
    assert_eq!(centers, [[2000.0, 0.0, -400.0]]);
    let turns = rerun::Boxes3D::descriptor_quaternions();
    let turns = read.each(entity, &turns, |turn: components::RotationQuat| turn.0.xyzw());
    assert_close(turns[0], QUARTER_TURN);
    let colors = rerun::Boxes3D::descriptor_colors();
    let colors = read.each(entity, &colors, |color: components::Color| color.to_array());
    assert_eq!(colors[0], [0, 128, 255, 153]);

    assert_eq!(read.activations, 1, "of the layout");
    assert!(read.shows("surroundings"));
    // The view is of everything: x from -50 to 2050 mm.
    let target = layout::EyeControls3D::descriptor_look_target();
    let targets = read.of_layout::<components::Position3D>(&target);
    assert!(targets.iter().any(|target| (target.x() - 1000.0).abs() < 1.0), "{targets:?}");
}

#[test]
fn cuts_rapids_and_the_prepared_path_are_separate() {
    let read = record(1, false);
    let strips = rerun::LineStrips3D::descriptor_strips();
    let lines =
        |entity| read.each(entity, &strips, |strip: components::LineStrip3D| strip.0[1].0[0]);
    assert_eq!(lines("program/cuts/1"), [250.0, 1000.0]);
    assert_eq!(lines("program/rapids/1"), [500.0]);
    assert_eq!(lines("program/prepared/1"), [2000.0]);
}

#[test]
fn a_trail_is_whole_and_every_piece_is_sent_once() {
    let read = record(1001, true);
    for (name, behind) in [("set-point", 0.0), ("twin", 0.002), ("drives", 0.003_f32)] {
        let pieces = read.strips(&format!("trail/{name}"));
        assert!((4..=6).contains(&pieces.len()), "{name}: {}", pieces.len());
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].1.last(), pair[1].1.first(), "{name}: a gap");
        }
        let points: usize = pieces.iter().map(|(_, points)| points.len()).sum();
        // One each 4 ms, and one more per piece.
        assert!((250..=257).contains(&points), "{name}: {points}");
        for (time_ns, points) in &pieces {
            // 1 µm per ms: at 1 s the tool is at 1 mm. No piece shows what has not happened yet.
            let reached = f64::from(points.last().unwrap()[0] + behind);
            let off = (reached - seconds(*time_ns)).abs();
            assert!(off <= 0.004, "{name}: {reached} mm at {time_ns} ns");
        }
    }
    let newest = read.strips("trail/newest");
    assert_eq!(newest.len(), 3 * 51);
    for ((time_ns, points), behind) in
        newest.iter().zip([0.0, 0.002, 0.003_f32].into_iter().cycle())
    {
        let reached = f64::from(points.last().unwrap()[0] + behind);
        assert!((reached - seconds(*time_ns)).abs() < 1e-6, "{reached} mm at {time_ns} ns");
        assert!(points.len() <= 52, "the newest end grows: {}", points.len());
    }
}

#[test]
fn a_machine_without_drives_shows_none() {
    let read = record(30, false);
    assert_eq!(read.entities(|path| path.contains("drives")), [""; 0]);
    assert!(read.of("tool/twin/dot").next().is_some());
}

#[test]
fn the_line_being_run_is_shown_when_it_changes() {
    let read = record(25, false);
    let text = rerun::TextDocument::descriptor_text();
    let here = read.rows::<components::Text>("program/here", &text);
    let places: Vec<_> = here.iter().map(|(time, line, _)| (*time / 1_000_000, *line)).collect();
    assert_eq!(places, [(0, 1), (10, 2), (20, 3)]);
    assert!(here[1].2[0].0.contains("▶     2  N10 G0 X10\n"), "{here:?}");
}

#[test]
fn only_the_time_of_the_program_is_in_the_recording() {
    let read = record(25, true);
    for chunk in read.chunks.iter().filter(|chunk| !chunk.is_static()) {
        let mut timelines: Vec<_> = chunk.timelines().keys().map(ToString::to_string).collect();
        timelines.sort();
        assert_eq!(timelines, ["line", "time"], "{}", chunk.entity_path());
    }
}

#[test]
fn a_frame_for_another_machine_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = open_file(&folder.path().join("a.rrd"));
    let poses = [Isometry3::identity(); 2];
    let fitting = still(0, &poses);
    let mut refuse = |frame: Frame<'_>| scene.frame(&frame).unwrap_err();
    assert_miscounted(&refuse(still(0, &poses[..1])), "link poses", [2, 1]);
    let deviation = |axis_errors| Deviation { axis_errors, ..still(0, &poses).twin };
    let twin = deviation(&[0.0][..]);
    assert_miscounted(&refuse(Frame { twin, ..still(0, &poses) }), "axis errors", [2, 1]);
    let drives = Some(DrivesFrame { deviation: deviation(&[0.0; 3][..]), tool_error_to_twin: 0.0 });
    assert_miscounted(&refuse(Frame { drives, ..still(0, &poses) }), "axis errors", [2, 3]);
    scene.frame(&fitting).unwrap();
}

#[test]
fn a_scene_must_go_somewhere_that_can_be_written() {
    assert!(matches!(open(&SceneOptions::default()), Err(VizError::NoDestination)));
    let record = Some("/nowhere/run.rrd".into());
    let error = open(&SceneOptions { record, ..SceneOptions::default() }).unwrap_err();
    let VizError::Create { path, .. } = error else { panic!("{error:?}") };
    assert_eq!(path, Path::new("/nowhere/run.rrd"));
}

#[test]
fn a_taken_address_costs_no_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("precious.rrd");
    std::fs::write(&path, "yesterday's run").unwrap();
    let holder = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let taken = holder.local_addr().unwrap();
    let (record, serve) = (Some(path.clone()), Some(taken));
    let error = open(&SceneOptions { record, serve, ..SceneOptions::default() }).unwrap_err();
    assert!(matches!(&error, VizError::Bind { address, .. } if *address == taken), "{error:?}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "yesterday's run");
}

#[test]
fn file_and_page_at_once_are_the_same_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("both.rrd");
    let (record, serve) = (Some(path.clone()), Some(SocketAddr::from(([127, 0, 0, 1], 0))));
    let mut scene = open(&SceneOptions { record, serve, ..SceneOptions::default() }).unwrap();
    let address = scene.viewer().unwrap().address();
    let reader =
        std::thread::Builder::new().spawn(move || crate::server::tests::download(address)).unwrap();
    (0..300).for_each(|ms| log_ms(&mut scene, ms, true));
    let viewer = scene.finish().unwrap().unwrap();
    let downloaded = reader.join().unwrap();
    assert_eq!(downloaded, std::fs::read(&path).unwrap());
    assert_eq!(Read::new(&path).scalars("error/tool/twin").len(), 300);
    // The page outlives the run.
    assert_eq!(crate::server::tests::download(viewer.address()), downloaded);
}

#[test]
fn a_scene_given_up_half_way_leaves_a_readable_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("half.rrd");
    let mut scene = open_file(&path);
    (0..30).for_each(|ms| log_ms(&mut scene, ms, false));
    drop(scene);
    assert_eq!(Read::new(&path).places("machine/arm 1").len(), 3);
}

#[test]
fn equal_frames_and_numbers_make_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    let recorded = |number| {
        let record = Some(path.clone());
        let mut scene = open(&SceneOptions { record, number, ..SceneOptions::default() }).unwrap();
        // Some batches of 2 s.
        (0..5000).for_each(|ms| log_ms(&mut scene, ms, ms % 25 == 5));
        scene.finish().unwrap();
        std::fs::read(&path).unwrap()
    };
    assert!(recorded(Some(7)) == recorded(Some(7)));
    assert!(recorded(Some(7)) != recorded(Some(8)));
    assert!(recorded(None) != recorded(None));
}

#[test]
fn a_recording_that_is_removed_or_replaced_is_an_error_at_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    for replaced in [false, true] {
        let mut scene = open_file(&path);
        log_ms(&mut scene, 1, false);
        std::fs::remove_file(&path).unwrap();
        if replaced {
            std::fs::write(&path, "another").unwrap();
        }
        let error = scene.close().unwrap_err();
        let VizError::Write { ended, .. } = error else { panic!("{error:?}") };
        assert_eq!(ended.cause.kind(), std::io::ErrorKind::NotFound);
        drop(scene);
        assert_eq!(path.exists(), replaced);
    }
}
