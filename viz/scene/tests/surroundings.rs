//! Tests of the obstacles in a recording.

use super::*;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use rerun::external::re_sdk_types::blueprint::components::QueryExpression;

/// It has no time, an entity of its own, is translucent, and the camera sees it.
#[test]
fn obstacles_stand_beside_the_machine() {
    let read = record(1, false);
    let entity = "surroundings/fixed jaw/boxes";
    let sizes = rerun::Boxes3D::descriptor_half_sizes();
    let sizes = read.each(entity, &sizes, |size: components::HalfSize3D| size.0.0);
    assert_eq!(sizes, [[100.0, 50.0, 25.0]]);
    let centers = rerun::Boxes3D::descriptor_centers();
    let centers = read.each(entity, &centers, |center: components::Translation3D| center.0.0);
    assert_eq!(centers, [[2000.0, 0.0, -400.0]]);
    let turns =
        read.statics::<components::RotationQuat>(entity, &rerun::Boxes3D::descriptor_quaternions());
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for (found, wanted) in turns[0].0.xyzw().iter().zip([0.0, 0.0, half, half]) {
        assert!((found - wanted).abs() < 1e-6, "{turns:?}");
    }
    let colors = read.statics::<components::Color>(entity, &rerun::Boxes3D::descriptor_colors());
    assert_eq!(colors[0].to_array(), [0, 128, 255, 153]);

    let queries = read.of_layout::<QueryExpression>(&layout::ViewContents::descriptor_query());
    assert!(queries.iter().any(|query| query.0.as_str() == "+ /surroundings/**"), "{queries:?}");
    // The view is of everything: x from -50 to 2050 mm.
    let target = layout::EyeControls3D::descriptor_look_target();
    let targets = read.of_layout::<components::Position3D>(&target);
    assert!(targets.iter().any(|target| (target.x() - 1000.0).abs() < 1.0), "{targets:?}");
}
