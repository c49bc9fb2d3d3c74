//! Path operations before preparation: split, scale, rotate, translate, linearise, reverse (manual 3.3 and 6.3).

use super::source::{Decoded, Halt};
use nalgebra::Vector3;
use std::io;
use twin_path::{
    Chords, ExtraPosition, Linearise, MapPath, OperationError, PathElement, Similarity, SplitAt,
    reversed,
};

/// Operations on a path, in this order: cut an object in two; scale, turn and move the path; replace its curves by
/// lines; reverse it.
#[derive(Clone, Debug, PartialEq)]
pub struct Operations {
    /// The object of this number, from 0, is cut in two at this part of its length, 0 to 1.
    pub split: Option<(u64, f64)>,
    /// Stretched by this factor about the origin (`SMC_SCALEQUEUE3D`).
    pub scale: f64,
    /// Turned counter-clockwise about the z axis, rad (`SMC_ROTATEQUEUE2D`).
    pub rotate: f64,
    /// Moved, m (`SMC_TRANSLATEQUEUE3D`).
    pub translate: [f64; 3],
    /// And the additional axes, u.
    pub translate_additional: ExtraPosition,
    /// Splines and ellipses are made lines.
    pub linearise: Option<Chords>,
    /// And so are arcs.
    pub arcs: bool,
    /// From its end to its start; holds the whole path in memory.
    pub reverse: bool,
}

impl Default for Operations {
    fn default() -> Self {
        Self {
            split: None,
            scale: 1.0,
            rotate: 0.0,
            translate: [0.0; 3],
            translate_additional: ExtraPosition::default(),
            linearise: None,
            arcs: false,
            reverse: false,
        }
    }
}

impl Operations {
    /// The map of points.
    ///
    /// # Errors
    /// If the factor is none.
    pub fn similarity(&self) -> Result<Similarity, OperationError> {
        let moved = Similarity::translation(Vector3::from(self.translate))
            .with_extra_axes(self.translate_additional);
        Ok(Similarity::scaling(self.scale)?.then(&Similarity::rotation(self.rotate)).then(&moved))
    }

    /// The elements of `path` after all of this.
    pub(super) fn apply(&self, path: Decoded) -> io::Result<Operated> {
        if *self == Self::default() {
            return Ok(Operated::Unchanged(path));
        }
        let mut path: Path = Box::new(path);
        if let Some((object, at)) = self.split {
            path = Box::new(SplitAt::new(path, object, at));
        }
        let similarity = self.similarity().map_err(io::Error::other)?;
        path = Box::new(MapPath::new(path, similarity));
        if let Some(chords) = self.linearise {
            let lines = Linearise::new(path, chords);
            path = Box::new(if self.arcs { lines.with_arcs() } else { lines });
        }
        if self.reverse {
            let backwards = move || match path.collect::<Result<Vec<_>, Halt>>() {
                Ok(path) => reversed(&path).into_iter().map(Ok).collect(),
                Err(halt) => vec![Err(halt)],
            };
            path = Box::new(std::iter::once_with(backwards).flatten());
        }
        Ok(Operated::Changed(path))
    }
}

type Path = Box<dyn Iterator<Item = Result<PathElement, Halt>>>;

/// A path after [`Operations`].
pub(crate) enum Operated {
    Unchanged(Decoded),
    Changed(Path),
}

impl std::fmt::Debug for Operated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unchanged(path) => f.debug_tuple("Unchanged").field(path).finish(),
            Self::Changed(_) => f.debug_tuple("Changed").finish_non_exhaustive(),
        }
    }
}

impl Iterator for Operated {
    type Item = Result<PathElement, Halt>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Self::Unchanged(path) => path.next(),
            Self::Changed(path) => path.next(),
        }
    }
}
