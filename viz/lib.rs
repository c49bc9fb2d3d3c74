//! 3D view and plots of a run: the moving machine, its paths, and the tracking errors of the twin and the drives.
//!
//! A [`Scene`] writes a [rerun](https://rerun.io) recording to a file ([`SceneOptions::record`]), a browser page
//! ([`SceneOptions::serve`]), or both. The page is rerun's web viewer, shipped inside this binary; it reads the
//! growing file, so memory does not grow with the program. [`view_recording`] serves a finished recording.
//!
//! Everything handed to a [`Scene`] is SI, in the machine frame; everything a person sees is mm, degrees and mm/s.
//!
//! | entity | what | timelines |
//! |---|---|---|
//! | `machine/<link>` | pose of a link of the twin; its solids below it | `time`, `line` |
//! | `surroundings/<name>` | an obstacle of the machine file; its solids below it | static |
//! | `program/cuts/<n>`, `program/rapids/<n>` | programmed path | static |
//! | `program/prepared/<n>` | path after preparation, where the program asks for any | static |
//! | `trail/{set-point,twin,drives}` | path travelled, in pieces; their newest ends in `trail/newest` | `time`, `line` |
//! | `tool/{set-point,twin,drives}` | tool position | `time`, `line` |
//! | `error/tool/{twin,drives,between}` | distance of the tool to the set-point, and between drives and twin, mm | `time`, `line` |
//! | `error/axis_deg/<axis>/{twin,drives}`, `error/axis_mm/…` | axis position minus set-point | `time`, `line` |
//! | `motor/force_n/<axis>/{twin,limit}`, `motor/torque_nm/…` | effort of the motor, and its limit (hidden until clicked in the legend), at the axis | `time`, `line` |
//! | `motor/{power_w,utilisation_percent,warmth_percent,load_angle_full_steps}/<axis>/twin` | mechanical power; effort against what the motor can give; I²t; field of a step motor against its rotor | `time`, `line` |
//! | `clearance/{twin,wanted}` | distance between the nearest parts of the twin and its surroundings, mm; below 0 they penetrate each other | `time`, `line` |
//! | `nearest/{line,points}` | those parts joined where they are nearest, while they are near | `time`, `line` |
//! | `speed/{set-point,programmed}` | along the path, mm/s | `time`, `line` |
//! | `workspace/{section,lines,marks}` | a section through the workspace ([`show_workspace`]) | static |
//! | `program/here`, `about` | lines around the current one; names and colours | `time`, `line`; static |
//!
//! `time` counts from the start of the program; `line` is the line of the program file, from 1.
//!
//! ```
//! use twin_urdf::Model;
//! use twin_viz::{Axis, AxisUnit, Deviation, Frame, Program, Scene, SceneOptions, Setup};
//!
//! # const ARM: &str = r#"
//! # <robot name="arm">
//! #   <link name="base"/>
//! #   <link name="arm"/>
//! #   <link name="tool_tip"/>
//! #   <joint name="A" type="revolute">
//! #     <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
//! #     <limit lower="-3" upper="3" effort="10" velocity="2"/>
//! #   </joint>
//! #   <joint name="tool_tip" type="fixed">
//! #     <parent link="arm"/><child link="tool_tip"/><origin xyz="0.3 0 0"/>
//! #   </joint>
//! # </robot>"#;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // An arm of 300 mm, whose model is URDF in the text ARM, recorded at 0 degrees.
//! let model = Model::from_urdf(ARM, &["A"])?;
//! let (poses, tool) = (model.link_poses(&[0.0]), model.tip_position(&[0.0]));
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("arm.rrd");
//! let options = SceneOptions { record: Some(file.clone()), ..SceneOptions::default() };
//! let setup = Setup {
//!     machine: &model,
//!     home: &poses,
//!     surroundings: &[],
//!     bodies: &[],
//!     clearance: None,
//!     axes: &[Axis { name: "A".to_owned(), unit: AxisUnit::Rotary }],
//!     program: Program { name: "arm.cnc", text: "% arm" },
//!     drives: None,
//! };
//! let mut scene = Scene::open(&options, &setup)?;
//! scene.frame(&Frame {
//!     time_ns: 0,
//!     line: 1,
//!     setpoint: tool,
//!     path_speed: 0.0,
//!     programmed_speed: None,
//!     link_poses: &poses,
//!     body_poses: &[],
//!     twin: Deviation { tool, tool_error: 0.0, axis_errors: &[0.0] },
//!     motors: &[],
//!     clearance: None,
//!     drives: None,
//! })?;
//! scene.finish()?;
//! // Recordings of rerun begin with these letters.
//! assert!(std::fs::read(&file)?.starts_with(b"RRF"));
//! # Ok(())
//! # }
//! ```

mod background;
mod blueprint;
mod bounds;
mod error;
mod frame;
mod motor_plot;
mod palette;
mod recorder;
mod scene;
mod server;
mod timeline;
mod units;
mod workspace;

pub use background::{Background, Ended, Item, Sink};
pub use error::{Result, VizError};
pub use frame::{
    Axis, AxisUnit, Body, ClearanceFrame, Deviation, DrivesFrame, Frame, MotorFrame, MoveKind,
    Obstacle, PathStrip, Program,
};
pub use scene::{Scene, SceneOptions, Setup};
pub use server::{DEFAULT_ADDRESS, Viewer, view_recording};
pub use timeline::Playback;
pub use workspace::{Mark, SheetLine, WorkspaceView, show_workspace};
