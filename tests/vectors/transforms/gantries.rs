//! Gantries (manual 8.2.1 to 8.2.3).

use super::vector::{Vector, check};
use nalgebra::{SVector, Vector2, Vector3};
use twin_kinematics::ToPath;
use twin_kinematics::gantry::{
    BeltLayout, Gantry2, Gantry3, GantryCutter2, GantryH2, Sense, ToolBeside,
};
use twin_kinematics::transform::{Motion, Transform};

/// Lengths among the inputs, mm, as m.
pub(crate) fn lengths<const N: usize>(vector: &Vector, name: &str) -> [f64; N] {
    point::<N>(vector, name).into()
}

/// A position among the inputs, mm, as m.
pub(crate) fn point<const N: usize>(vector: &Vector, name: &str) -> SVector<f64, N> {
    SVector::from_vec(vector.numbers(name)) * 1e-3
}

/// Lengths in m as mm.
pub(crate) fn mm<const N: usize>(values: SVector<f64, N>) -> Vec<f64> {
    values.iter().map(|value| value * 1e3).collect()
}

#[test]
pub(crate) fn three_axes() {
    check("trafo-gantry3", |vector| {
        let gantry = Gantry3::new(lengths(vector, "off")).unwrap();
        let axes = gantry.to_axes(&point(vector, "pi")).unwrap();
        vector.expect("d", mm(axes));
        vector.expect("fwd", mm(gantry.to_tool(&axes).unwrap()));
    });
}

/// The direction comes from the tangent, the axis from the direction, also through the transform; and back.
#[test]
pub(crate) fn cutter() {
    check("trafo-cutter", |vector| {
        let tangent = vector.numbers("v");
        let direction = ToPath::Tangential.direction(Vector2::new(tangent[0], tangent[1])).unwrap();
        vector.expect("tangent_deg", [direction.to_degrees()]);
        let sense = match vector.number("iDirectionR").partial_cmp(&0.0) {
            Some(std::cmp::Ordering::Less) => Sense::Clockwise,
            _ => Sense::CounterClockwise,
        };
        let offset = vector.number("dOffsetR").to_radians();
        let gantry = GantryCutter2::new([0.0, 0.0, offset], sense).unwrap();
        vector.expect("dr", [gantry.turned(direction).to_degrees()]);
        let tool = Vector3::new(0.0, 0.0, direction);
        let near = Vector3::new(0.0, 0.0, 200_f64.to_radians());
        let axes = gantry.to_axes_near(&tool, &near).unwrap();
        vector.expect("dr", [axes.z.to_degrees()]);
        let back = gantry.to_tool(&axes).unwrap().z - direction;
        assert!((back.sin().abs() < 1e-12) && back.cos() > 0.0, "{back}");
    });
}

#[test]
pub(crate) fn velocities() {
    check("trafov-gantry3", |vector| {
        let tangent = SVector::<f64, 3>::from_vec(vector.numbers("v"));
        let velocity = tangent * (vector.number("dVel") * 1e-3);
        // Neither where the tool is nor the offsets matter.
        let gantry = Gantry3::new([0.1, -0.2, 0.3]).unwrap();
        let position = Vector3::new(0.5, 0.6, 0.7);
        let tool = Motion { position, velocity, acceleration: Vector3::zeros() };
        let axes = gantry.axis_motion(&tool, &Vector3::zeros()).unwrap();
        vector.expect("dv", mm(axes.velocity));
        assert_eq!(axes.acceleration, Vector3::zeros());
    });
}

fn with_tool(vector: &Vector, left: f64) -> Gantry2 {
    let beside = ToolBeside {
        angle: vector.number("dAlpha").to_radians(),
        ahead: vector.number("dToolA") * 1e-3,
        left,
    };
    Gantry2::with_tool_offset(lengths(vector, "off"), beside).unwrap()
}

#[test]
pub(crate) fn tool_on_one_leg() {
    check("trafo-tool1", |vector| {
        let gantry = with_tool(vector, 0.0);
        vector.expect("d", mm(gantry.to_axes(&point(vector, "pi")).unwrap()));
    });
}

#[test]
pub(crate) fn tool_on_two_legs() {
    check("trafo-tool2", |vector| {
        let gantry = with_tool(vector, vector.number("dToolB") * 1e-3);
        let axes = gantry.to_axes(&point(vector, "pi")).unwrap();
        vector.expect("d", mm(axes));
        vector.expect("fwd", mm(gantry.to_tool(&axes).unwrap()));
    });
}

#[test]
pub(crate) fn h_belt() {
    check("trafo-gantryH2", |vector| {
        let layout = BeltLayout::default();
        let gantry = GantryH2::new(lengths(vector, "off"), layout).unwrap();
        let axes = gantry.to_axes(&point(vector, "pi")).unwrap();
        vector.expect("da", [axes.x * 1e3]);
        vector.expect("db", [axes.y * 1e3]);
        vector.expect("fwd", mm(gantry.to_tool(&axes).unwrap()));
        let drives = point::<2>(vector, "home_drives");
        let home = GantryH2::home(layout, drives.into()).unwrap();
        vector.expect("home_offset", home.offsets().map(|offset| offset * 1e3));
        // Which is what the offsets are for.
        assert!(home.to_tool(&drives).unwrap().norm() < 1e-15);
    });
}
