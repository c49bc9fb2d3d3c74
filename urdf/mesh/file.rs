//! Mesh file reader: STL (`stl_io`) and OBJ (`tobj`).
//!
//! Both crates get only input that they handle safely: of an OBJ file the vertices and faces, of an ASCII STL file one
//! solid. Every file, of any bytes, gives a mesh or an error.

use super::Mesh;
use nalgebra::Point3;
use std::collections::HashMap;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};
use twin_files::limited_read;

/// What a binary STL file has before its triangles, bytes.
const STL_HEADER: usize = 84;
/// Of a triangle of a binary STL file, bytes.
const STL_TRIANGLE: usize = 50;
/// More than any body needs that is to be simulated and shown.
const MOST_BYTES: u64 = 512 << 20;

/// A mesh file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// It cannot be read.
    #[error("{0}")]
    Read(#[source] io::Error),
    /// Another format.
    #[error("{} files cannot be read: meshes are STL or OBJ", .0.as_deref().unwrap_or("nameless"))]
    Format(Option<String>),
    /// No STL file.
    #[error("not STL: {0}")]
    Stl(#[source] io::Error),
    /// No OBJ file.
    #[error("not OBJ: {0}")]
    Obj(#[source] tobj::LoadError),
    /// It has no triangle.
    #[error("it has no triangle")]
    Empty,
    /// A corner is nowhere.
    #[error("vertex {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// A triangle has a corner that is not there.
    #[error("a triangle has the corner {corner}, of {vertices} vertices")]
    Corner {
        /// From 0.
        corner: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// More corners than can be counted.
    #[error("it has too many vertices")]
    TooMany,
}

impl Mesh {
    /// Reads the STL or OBJ file `path`, which URDF names `name`.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn load(path: &Path, name: &str) -> Result<Self, MeshError> {
        let bytes = limited_read::read_binary(path, MOST_BYTES).map_err(MeshError::Read)?;
        Self::parse(&bytes, path, name)
    }

    /// The mesh that `bytes` are, in the format that `path` ends with; URDF names it `name`.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn parse(bytes: &[u8], path: &Path, name: &str) -> Result<Self, MeshError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().into_owned());
        match extension.as_deref().map(str::to_ascii_lowercase).as_deref() {
            Some("stl") => stl(bytes, name),
            Some("obj") => obj(bytes, name),
            _ => Err(MeshError::Format(extension)),
        }
    }
}

/// Corners that are one place are one vertex.
#[derive(Default)]
struct Vertices {
    list: Vec<Point3<f64>>,
    known: HashMap<[u32; 3], u32>,
}

impl Vertices {
    fn place(&mut self, coordinates: [f32; 3]) -> Result<u32, MeshError> {
        // −0 and 0 are one place.
        let key = coordinates.map(|value| (value + 0.0).to_bits());
        if let Some(index) = self.known.get(&key) {
            return Ok(*index);
        }
        let index = u32::try_from(self.list.len()).map_err(|_more| MeshError::TooMany)?;
        self.list.push(Point3::from(coordinates.map(|value| f64::from(value + 0.0))));
        self.known.insert(key, index);
        Ok(index)
    }
}

fn stl(bytes: &[u8], name: &str) -> Result<Mesh, MeshError> {
    let text = if is_binary(bytes) { None } else { ascii(bytes) };
    let bytes = text.map_or_else(
        || {
            // The header may say anything, "solid" too.
            let (header, rest) = bytes.split_at_checked(80).unwrap_or((&[], bytes));
            [&vec![0; header.len()], rest].concat()
        },
        String::into_bytes,
    );
    let mut cursor = Cursor::new(bytes);
    let broken = |source| MeshError::Stl(source);
    let mut vertices = Vertices::default();
    let mut triangles = Vec::new();
    for triangle in stl_io::create_stl_reader(&mut cursor).map_err(broken)? {
        let [first, second, third] = triangle.map_err(broken)?.vertices.map(<[f32; 3]>::from);
        triangles.push([vertices.place(first)?, vertices.place(second)?, vertices.place(third)?]);
    }
    Mesh::new(name, vertices.list, triangles)
}

/// True if the number of triangles that a binary STL file would have here is that of its bytes.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..STL_HEADER).and_then(|count| count.try_into().ok());
    let triangles = count.map(u32::from_le_bytes).and_then(|count| usize::try_from(count).ok());
    let expected = triangles
        .and_then(|count| count.checked_mul(STL_TRIANGLE))
        .and_then(|size| size.checked_add(STL_HEADER));
    expected == Some(bytes.len())
}

/// An ASCII STL file with everything in one solid; `None` if it does not begin like one.
fn ascii(bytes: &[u8]) -> Option<String> {
    let start = bytes.trim_ascii_start();
    let keyword = start.get(..5).unwrap_or_default();
    if !keyword.eq_ignore_ascii_case(b"solid") || bytes.contains(&0) {
        return None;
    }
    let text = String::from_utf8_lossy(start);
    let keeps = |line: &&str| {
        let word = line.split_whitespace().next().unwrap_or_default();
        !word.is_empty() && word != "solid" && word != "endsolid"
    };
    // Words may be in capitals; numbers do not mind.
    let lines = text.lines().map(str::to_ascii_lowercase);
    let mut whole = String::from("solid mesh\n");
    for line in lines.collect::<Vec<_>>().iter().map(String::as_str).filter(keeps) {
        whole.push_str(line);
        whole.push('\n');
    }
    whole.push_str("endsolid mesh\n");
    Some(whole)
}

fn obj(bytes: &[u8], name: &str) -> Result<Mesh, MeshError> {
    let text = places_and_faces(&String::from_utf8_lossy(bytes));
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Ok((Vec::new(), HashMap::default()));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(text), &options, no_materials)
        .map_err(MeshError::Obj)?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let before = u32::try_from(vertices.len()).map_err(|_more| MeshError::TooMany)?;
        let (places, _) = mesh.positions.as_chunks::<3>();
        vertices.extend(places.iter().map(|place| Point3::from(*place)));
        let (faces, _) = mesh.indices.as_chunks::<3>();
        for face in faces {
            let [first, second, third] = face.map(|corner| before.checked_add(corner));
            triangles.push([
                first.ok_or(MeshError::TooMany)?,
                second.ok_or(MeshError::TooMany)?,
                third.ok_or(MeshError::TooMany)?,
            ]);
        }
    }
    Mesh::new(name, vertices, triangles)
}

/// Of an OBJ file what makes its triangles: `v x y z` and `f` without textures and normals. Lines may go on after a
/// backslash.
fn places_and_faces(text: &str) -> String {
    let mut kept = String::new();
    for line in text.replace("\\\r\n", " ").replace("\\\n", " ").lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                kept.push('v');
                words.take(3).for_each(|word| kept.extend([" ", word]));
                kept.push('\n');
            }
            Some("f") => {
                kept.push('f');
                let corners = words.map(|word| word.split('/').next().unwrap_or_default());
                corners.for_each(|corner| kept.extend([" ", corner]));
                kept.push('\n');
            }
            _ => {}
        }
    }
    kept
}

/// Loads a mesh from the first of `places` that is a file; `None` if none is. An error comes with that file's path.
pub(crate) fn load_first(
    places: &[PathBuf],
    name: &str,
) -> Option<Result<Mesh, (PathBuf, MeshError)>> {
    let found = places.iter().find(|place| place.is_file())?;
    Some(Mesh::load(found, name).map_err(|error| (found.clone(), error)))
}
