//! Solids in the recording, as rerun shapes.

use nalgebra::Vector3;
use rerun::FillMode;
use twin_urdf::{Mesh, Solid, SolidShape};

use crate::error::Result;
use crate::recorder::Recorder;
use crate::units;

/// Logs `solids` below `entity`, in its frame, without a time.
pub(super) fn log(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    log_boxes(stream, entity, solids)?;
    log_cylinders(stream, entity, solids)?;
    log_spheres(stream, entity, solids)?;
    log_capsules(stream, entity, solids)?;
    log_meshes(stream, entity, solids)
}

fn centers(solids: &[&Solid]) -> Vec<[f32; 3]> {
    solids.iter().map(|solid| units::vector_mm(&solid.origin.translation.vector)).collect()
}

fn quaternions(solids: &[&Solid]) -> Vec<rerun::Quaternion> {
    solids.iter().map(|solid| units::quaternion(&solid.origin)).collect()
}

fn colors(solids: &[&Solid]) -> Vec<rerun::Color> {
    solids.iter().map(|solid| units::color(&solid.color)).collect()
}

/// The solids of one shape, with what `measure` takes from it.
fn of_shape<T>(
    solids: &[Solid],
    measure: impl Fn(&SolidShape) -> Option<T>,
) -> (Vec<&Solid>, Vec<T>) {
    solids
        .iter()
        .filter_map(|solid| measure(&solid.shape).map(|measures| (solid, measures)))
        .unzip()
}

fn log_boxes(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    let (solids, sizes) = of_shape(solids, |shape| match shape {
        SolidShape::Box { size } => Some(units::vector_mm(size)),
        _ => None,
    });
    if !solids.is_empty() {
        let boxes = rerun::Boxes3D::from_centers_and_sizes(centers(&solids), sizes)
            .with_quaternions(quaternions(&solids))
            .with_colors(colors(&solids))
            .with_fill_mode(FillMode::Solid);
        stream.log_static(format!("{entity}/boxes"), &boxes)?;
    }
    Ok(())
}

fn log_cylinders(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    let (solids, measures) = of_shape(solids, |shape| match shape {
        SolidShape::Cylinder { radius, length } => {
            Some((units::mm_f32(*length), units::mm_f32(*radius)))
        }
        _ => None,
    });
    if !solids.is_empty() {
        let (lengths, radii): (Vec<_>, Vec<_>) = measures.into_iter().unzip();
        let cylinders = rerun::Cylinders3D::from_lengths_and_radii(lengths, radii)
            .with_centers(centers(&solids))
            .with_quaternions(quaternions(&solids))
            .with_colors(colors(&solids))
            .with_fill_mode(FillMode::Solid);
        stream.log_static(format!("{entity}/cylinders"), &cylinders)?;
    }
    Ok(())
}

fn log_spheres(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    let (solids, radii) = of_shape(solids, |shape| match shape {
        SolidShape::Sphere { radius } => Some(units::mm_f32(*radius)),
        _ => None,
    });
    if !solids.is_empty() {
        let spheres = rerun::Ellipsoids3D::from_centers_and_radii(centers(&solids), radii)
            .with_colors(colors(&solids))
            .with_fill_mode(FillMode::Solid);
        stream.log_static(format!("{entity}/spheres"), &spheres)?;
    }
    Ok(())
}

fn log_capsules(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    let (solids, measures) = of_shape(solids, |shape| match shape {
        SolidShape::Capsule { radius, length } => {
            Some((units::mm_f32(*length), units::mm_f32(*radius)))
        }
        _ => None,
    });
    if !solids.is_empty() {
        // Those of rerun begin at their origin and go up from there.
        let (lengths, radii): (Vec<_>, Vec<_>) = measures.into_iter().unzip();
        let below = solids.iter().zip(&lengths).map(|(solid, length)| {
            let down = Vector3::z() * (f64::from(*length) / 2e3);
            units::vector_mm(&(solid.origin.translation.vector - solid.origin.rotation * down))
        });
        let capsules = rerun::Capsules3D::from_lengths_and_radii(lengths.clone(), radii)
            .with_translations(below)
            .with_quaternions(quaternions(&solids))
            .with_colors(colors(&solids))
            .with_fill_mode(FillMode::Solid);
        stream.log_static(format!("{entity}/capsules"), &capsules)?;
    }
    Ok(())
}

/// Every mesh is an entity of its own, in the frame of its parent.
fn log_meshes(stream: &mut Recorder, entity: &str, solids: &[Solid]) -> Result<()> {
    let (solids, meshes) = of_shape(solids, |shape| match shape {
        SolidShape::Mesh { mesh, scale } => Some((mesh.clone(), *scale)),
        _ => None,
    });
    for (number, (solid, (mesh, scale))) in (1..).zip(solids.iter().zip(&meshes)) {
        stream.log_static(format!("{entity}/mesh{number}"), &triangles(solid, mesh, scale))?;
    }
    Ok(())
}

/// With corners of its own for every triangle: parts of machines have edges, which shared normals would round.
fn triangles(solid: &Solid, mesh: &Mesh, scale: &Vector3<f64>) -> rerun::Mesh3D {
    let mut corners = Vec::with_capacity(3 * mesh.triangles().len());
    let mut normals = Vec::with_capacity(3 * mesh.triangles().len());
    for [a, b, c] in mesh.corners(scale) {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let normal = (solid.origin.rotation * normal).map(units::f32_of);
        for corner in [a, b, c] {
            corners.push(units::point_mm(&(solid.origin * corner)));
            normals.push([normal.x, normal.y, normal.z]);
        }
    }
    rerun::Mesh3D::new(corners)
        .with_vertex_normals(normals)
        .with_albedo_factor(units::color(&solid.color).0)
}
