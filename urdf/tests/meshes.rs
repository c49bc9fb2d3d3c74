//! Tests of STL and OBJ files and of the search for them.

use super::{assert_near, seeded};
use crate::{Loaded, Mesh, MeshError, Model, SolidShape, UrdfFileError, UrdfOptions};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Of a box of 1 × 2 × 3 with a corner at the origin, whose sides are seen from outside.
fn corner(number: usize) -> [f32; 3] {
    [(1, 1.0), (2, 2.0), (4, 3.0)].map(|(bit, end)| if number & bit == 0 { 0.0 } else { end })
}

const SIDES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn triangles() -> impl Iterator<Item = [[f32; 3]; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner))
}

fn binary() -> Vec<u8> {
    // A header that lies.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        triangle.iter().flatten().for_each(|value| bytes.extend(value.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii(begin: &str) -> String {
    let mut text = format!("{begin}\n");
    for (number, [a, b, c]) in triangles().enumerate() {
        if number == 5 {
            text += "endsolid\nsolid another one\n";
        }
        text += "facet normal 0 0 0\n outer loop\n";
        for [x, y, z] in [a, b, c] {
            writeln!(text, "  vertex {x} {y} {z:e}").unwrap();
        }
        text += " endloop\nENDFACET\n";
    }
    text + "endsolid\n"
}

fn wavefront() -> String {
    let mut text = "# a box\nmtllib none.mtl\nvn 0 0 1\nvt 0 0\no box\n".to_owned();
    for [x, y, z] in (0..8).map(corner) {
        writeln!(text, "v {x} {y} {z} 1 0 0").unwrap();
    }
    for (number, side) in SIDES.into_iter().enumerate() {
        let [a, b, c, d] = side.map(|corner| corner + 1);
        // Counted from the end, too.
        let [e, f, g, h] = side.map(|corner| 8 - corner);
        match number {
            0 => writeln!(text, "g one\nf {a}/1/1 {b}//1 {c}/1 \\\n {d}").unwrap(),
            _ => writeln!(text, "f -{e} -{f} -{g} -{h}").unwrap(),
        }
    }
    text
}

fn parse(bytes: &[u8], name: &str) -> Result<Mesh, MeshError> {
    Mesh::parse(bytes, Path::new(name), name)
}

#[test]
fn every_format_makes_the_box() {
    for (name, bytes) in [
        ("binary.STL", binary()),
        ("ascii.stl", ascii("solid").into_bytes()),
        ("named.stl", ascii("  solid box of 12").into_bytes()),
        ("CAPITALS.STL", ascii("solid").to_uppercase().into_bytes()),
        ("box.obj", wavefront().into_bytes()),
    ] {
        let mesh = parse(&bytes, name).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mesh.file(), mesh.vertices().len(), mesh.triangles().len()), (name, 8, 12));
        let scale = Vector3::new(1e-3, -1e-3, 2e-3);
        let shape = SolidShape::Mesh { mesh: mesh.into(), scale };
        let volume = shape.volume().unwrap();
        assert!((volume - 12e-9).abs() < 1e-20, "{name}: {volume}");
        let [low, high] = shape.bounds();
        assert_near(low, [0.0, -2e-3, 0.0], 1e-15);
        assert_near(high, [1e-3, 0.0, 6e-3], 1e-15);
    }
}

#[test]
fn corners_go_round_as_seen_from_outside() {
    let mesh = parse(&binary(), "box.stl").unwrap();
    for scale in [[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]] {
        let scale = Vector3::from(scale);
        let middle = Vector3::new(0.5, 1.0, 1.5).component_mul(&scale);
        for [a, b, c] in mesh.corners(&scale) {
            let normal = (b - a).cross(&(c - a));
            assert!(normal.dot(&(a.coords - middle)) > 0.0, "{scale:?}: {a} {b} {c}");
        }
    }
}

#[test]
fn what_is_not_closed_is_known() {
    let closed = parse(&binary(), "box.stl").unwrap();
    let triangles = closed.triangles();
    let open_edges = |triangles: &[[u32; 3]]| {
        Mesh::new("a.stl", closed.vertices().to_vec(), triangles.to_vec()).unwrap().open_edges()
    };
    assert_eq!(open_edges(triangles), 0);
    // Without a triangle its three edges have one neighbour; turned round, three edges go the same way twice.
    assert_eq!(open_edges(&triangles[1..]), 3);
    let mut turned = triangles.to_vec();
    turned[0].swap(0, 1);
    assert_eq!(open_edges(&turned), 3);
    // A sheet is open all around.
    assert_eq!(open_edges(&triangles[..1]), 3);
}

#[test]
fn files_that_are_no_mesh() {
    let refusal = |bytes: &[u8], name: &str| parse(bytes, name).unwrap_err().to_string();
    assert_eq!(refusal(b"", "a.dae"), "dae files cannot be read: meshes are STL or OBJ");
    assert!(refusal(b"", "a.stl").starts_with("not STL: "));
    assert!(refusal(&binary()[..200], "a.stl").starts_with("not STL: "));
    assert!(refusal(b"solid a\nfacet normal 0 0 0\n", "a.stl").starts_with("not STL: "));
    assert_eq!(refusal(b"solid a\nendsolid", "a.stl"), "it has no triangle");
    assert!(refusal(b"v 0 0 0\nf 1 2 3\n", "a.obj").starts_with("not OBJ: "));
    assert!(refusal(b"v 0 0\n", "a.obj").starts_with("not OBJ: "));
    let nowhere = b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3";
    assert_eq!(refusal(nowhere, "a.obj"), "vertex 0 has a coordinate that is not a finite number");
    let corner = Mesh::new("m", vec![Point3::origin()], vec![[0, 0, 1]]);
    assert!(matches!(corner, Err(MeshError::Corner { corner: 1, vertices: 1 })));
}

/// A folder with `robot.urdf`, whose only mesh is `name`, and the mesh where `at` says.
fn folder(name: &str, at: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let text = format!(
        "<robot name='m'>\n<link name='base'>\n<visual><geometry>\n<mesh filename='{name}' scale='1e-3 1e-3 1e-3'/>\
         </geometry></visual></link><link name='tool_tip'/><joint name='t' type='fixed'><parent link='base'/>\
         <child link='tool_tip'/></joint></robot>"
    );
    for (path, bytes) in [("ws/robots/urdf/robot.urdf", text.as_bytes()), (at, &binary())] {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}

fn load(folder: &TempDir, packages: &[(&str, &str)]) -> Result<Loaded, UrdfFileError> {
    let packages =
        packages.iter().map(|(name, path)| ((*name).to_owned(), folder.path().join(path)));
    let options = UrdfOptions { packages: packages.collect(), ..UrdfOptions::default() };
    let path = folder.path().join("ws/robots/urdf/robot.urdf");
    Model::read_urdf(&fs::read_to_string(&path).unwrap(), &path, &options)
}

#[test]
fn meshes_are_found() {
    for (name, at) in [
        ("box.stl", "ws/robots/urdf/box.stl"),
        ("../meshes/box.stl", "ws/robots/meshes/box.stl"),
        // Packages are folders around the URDF, or next to those.
        ("package://robots/meshes/box.stl", "ws/robots/meshes/box.stl"),
        ("package://arms/meshes/box.stl", "ws/arms/meshes/box.stl"),
        ("model://arms/meshes/box.stl", "arms/meshes/box.stl"),
        // URIs are percent-decoded; other names, and a percent sign without two digits, are not.
        ("package://my%20arms/meshes/a%2fbox.stl", "ws/my arms/meshes/a/box.stl"),
        ("file://50%/%C3%A4rm%20box.stl", "ws/robots/urdf/50%/ärm box.stl"),
        ("a%20box.stl", "ws/robots/urdf/a%20box.stl"),
        // Carried about with the URDF: as much of the path as there is.
        ("package://arms/meshes/v2/box.stl", "ws/robots/urdf/v2/box.stl"),
        ("package://arms/meshes/v2/box.stl", "ws/robots/urdf/box.stl"),
    ] {
        let folder = folder(name, at);
        let model = load(&folder, &[]).unwrap_or_else(|error| panic!("{name}: {error}")).model;
        let SolidShape::Mesh { mesh, scale } = &model.links[0].solids[0].shape else { panic!() };
        assert_eq!((mesh.file(), mesh.triangles().len(), scale.x), (name, 12, 1e-3));
        // A URDF written next to the meshes is the same machine.
        let path = folder.path().join("ws/robots/urdf/again.urdf");
        let again = Model::read_urdf(&model.to_urdf().unwrap(), &path, &UrdfOptions::default());
        assert_eq!(again.unwrap().model, model);
    }
    let name = "package://arms/meshes/box.stl";
    let folder = folder(name, "elsewhere/meshes/box.stl");
    load(&folder, &[("other", "."), ("arms", "elsewhere")]).unwrap();
    let refusal = load(&folder, &[("arms", "nowhere")]).unwrap_err();
    let said = refusal.to_string();
    assert_eq!(refusal.line, 3, "{said}");
    for place in
        ["nowhere/meshes/box.stl", "ws/arms/meshes/box.stl", "urdf/meshes/box.stl", "urdf/box.stl"]
    {
        assert!(said.contains(place), "{place}: {said}");
    }
    assert!(said.contains("link base: there is no mesh package://arms/meshes/box.stl; looked at "));
    fs::write(folder.path().join("ws/robots/urdf/box.stl"), b"no mesh").unwrap();
    let said = load(&folder, &[]).unwrap_err().to_string();
    assert!(said.contains("urdf/box.stl: not STL: "), "{said}");
}

/// A refusal, or a mesh of which every triangle has its corners.
fn answered(bytes: &[u8], name: &str) -> Result<(), TestCaseError> {
    if let Ok(mesh) = parse(bytes, name) {
        let scale = Vector3::repeat(1.0);
        let corners = mesh.corners(&scale).flatten();
        let finite = corners.filter(|corner| corner.iter().all(|value| value.is_finite()));
        prop_assert_eq!(finite.count(), 3 * mesh.triangles().len());
    }
    Ok(())
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn any_bytes_are_answered(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in any::<prop::sample::Index>(),
    ) {
        for (name, mesh) in [
            ("a.stl", binary()), ("a.stl", ascii("solid").into_bytes()), ("a.obj", wavefront().into_bytes()), ("a.obj", bytes),
        ] {
            let mut mesh = mesh;
            for (at, byte) in &changes {
                if !mesh.is_empty() {
                    let at = at.index(mesh.len());
                    mesh[at] = *byte;
                }
            }
            answered(&mesh, name)?;
            mesh.truncate(cut.index(mesh.len() + 1));
            answered(&mesh, name)?;
        }
    }

    #[test]
    fn any_faces_are_answered(faces in prop::collection::vec("[-0-9/]{0,22}( [-0-9/]{1,22}){0,5}", 0..6)) {
        let lines = faces.iter().map(|face| format!("f {face}\n"));
        let text = wavefront() + &lines.collect::<String>();
        answered(text.as_bytes(), "a.obj")?;
    }
}
