//! Expansion of a drawing: inserts its blocks and gives chains of primitives.

use super::error::{DxfReadError, Note, Reason};
use super::export::RAPID;
use super::primitive::{Primitive, scaling};
use super::survey::{Items, Survey};
use super::{Limits, entity};
use ::dxf::entities::{Entity, EntityType, Insert};
use ::dxf::{Block, Drawing};
use nalgebra::{Affine3, Rotation3, Translation3, Vector3};
use std::collections::{BTreeMap, HashMap};

/// Connected pieces of one entity, m.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) pieces: Vec<Primitive>,
    pub(super) layer: String,
    /// True for straight lines on the layer RAPID.
    pub(super) rapid: bool,
    /// Line of the file.
    pub(super) line: u32,
}

/// Takes drawings apart.
pub(super) struct Expander<'a> {
    drawing: &'a Drawing,
    survey: &'a Survey,
    blocks: HashMap<String, (&'a Block, &'a Items)>,
    limits: Limits,
    /// In units of the drawing.
    tolerance: f64,
    /// Rapids of the drawing are kept.
    keeps_rapids: bool,
    /// Pieces and inserted blocks so far.
    count: usize,
    pub(super) chains: Vec<Chain>,
    notes: BTreeMap<(String, Reason), u64>,
}

/// Insertion of a block into the drawing.
#[derive(Clone, Copy)]
struct Insertion<'a> {
    map: Affine3<f64>,
    /// The layer of the INSERT, which is that of entities on layer 0.
    layer: Option<&'a str>,
    /// Of the outermost INSERT.
    line: Option<u64>,
    depth: usize,
}

impl<'a> Expander<'a> {
    /// # Errors
    /// [`DxfReadError::Incomplete`] if the crate has not read all that is in the file.
    pub(super) fn new(
        drawing: &'a Drawing,
        survey: &'a Survey,
        limits: Limits,
        tolerance: f64,
        keeps_rapids: bool,
    ) -> Result<Self, DxfReadError> {
        complete(drawing.entities(), &survey.entities)?;
        let found = drawing.blocks().count();
        if found < survey.blocks.len() {
            return Err(DxfReadError::Incomplete { expected: survey.blocks.len(), found });
        }
        let mut blocks = HashMap::new();
        for (block, items) in drawing.blocks().zip(&survey.blocks) {
            complete(block.entities.iter(), items)?;
            blocks.insert(block.name.to_uppercase(), (block, items));
        }
        Ok(Self {
            drawing,
            survey,
            blocks,
            limits,
            tolerance,
            keeps_rapids,
            count: 0,
            chains: Vec::new(),
            notes: BTreeMap::new(),
        })
    }

    /// Takes the drawing apart; a unit of it is `unit` m.
    ///
    /// # Errors
    /// [`DxfReadError`] if it goes beyond the limits.
    pub(super) fn run(&mut self, unit: f64) -> Result<(), DxfReadError> {
        let map = scaling(unit, unit, unit);
        let insertion = Insertion { map, layer: None, line: None, depth: 0 };
        self.entities(self.drawing.entities(), &self.survey.entities, insertion)
    }

    pub(super) fn notes(&self) -> Vec<Note> {
        let note = |((kind, reason), count): (&(String, Reason), &u64)| Note {
            kind: kind.clone(),
            reason: *reason,
            count: *count,
        };
        self.notes.iter().map(note).collect()
    }

    fn note(&mut self, kind: &str, reason: Reason, count: u64) {
        *self.notes.entry((kind.to_owned(), reason)).or_default() += count;
    }

    fn entities(
        &mut self,
        entities: impl Iterator<Item = &'a Entity>,
        items: &Items,
        insertion: Insertion<'a>,
    ) -> Result<(), DxfReadError> {
        for (kind, count) in &items.others {
            self.note(kind, Reason::NotUnderstood, *count);
        }
        for (entity, (kind, line)) in entities.zip(&items.understood) {
            if let Err(reason) = self.entity(entity, *line, insertion)? {
                self.note(kind, reason, 1);
            }
        }
        Ok(())
    }

    fn entity(
        &mut self,
        entity: &'a Entity,
        line: u64,
        insertion: Insertion<'a>,
    ) -> Result<Result<(), Reason>, DxfReadError> {
        let own = entity.common.layer.as_str();
        let layer = insertion.layer.filter(|_| own == "0").unwrap_or(own);
        let state = self.survey.layers.get(&layer.to_uppercase()).copied().unwrap_or_default();
        let hidden = [
            (state.frozen, Reason::FrozenLayer),
            (state.off, Reason::LayerOff),
            (!entity.common.is_visible, Reason::Invisible),
            (entity.common.is_in_paper_space, Reason::PaperSpace),
        ];
        if let Some((_, reason)) = hidden.into_iter().find(|(hidden, _)| *hidden) {
            return Ok(Err(reason));
        }
        if let EntityType::Insert(insert) = &entity.specific {
            let insertion = Insertion {
                layer: Some(layer),
                line: Some(insertion.line.unwrap_or(line)),
                ..insertion
            };
            return self.insert(insert, insertion);
        }
        let (pieces, exact) = match entity::pieces(entity, self.tolerance) {
            Ok(found) => found,
            Err(reason) => return Ok(Err(reason)),
        };
        let rapid = layer.eq_ignore_ascii_case(RAPID)
            && pieces.iter().all(|piece| matches!(piece, Primitive::Line { .. }));
        if rapid && !self.keeps_rapids {
            return Ok(Err(Reason::Rapid));
        }
        self.add(pieces.len())?;
        let pieces: Vec<_> = pieces.iter().map(|piece| piece.mapped(&insertion.map)).collect();
        let farthest = self.limits.farthest;
        let near = |piece: &Primitive| {
            piece.is_finite()
                && piece.start().coords.amax().max(piece.end().coords.amax()) <= farthest
        };
        if !pieces.iter().all(near) {
            return Ok(Err(Reason::Degenerate));
        }
        let line = u32::try_from(insertion.line.unwrap_or(line)).unwrap_or(u32::MAX);
        self.chains.push(Chain { pieces, layer: layer.to_owned(), rapid, line });
        Ok(if exact { Ok(()) } else { Err(Reason::Approximated) })
    }

    fn insert(
        &mut self,
        insert: &'a Insert,
        outer: Insertion<'a>,
    ) -> Result<Result<(), Reason>, DxfReadError> {
        let line = outer.line.unwrap_or_default();
        if outer.depth >= self.limits.depth {
            return Err(DxfReadError::TooDeep { line, limit: self.limits.depth });
        }
        let Some((block, items)) = self.blocks.get(&insert.name.to_uppercase()).copied() else {
            return Ok(Err(Reason::UnknownBlock));
        };
        let frame = match entity::frame(&insert.extrusion_direction) {
            Ok(frame) => frame,
            Err(reason) => return Ok(Err(reason)),
        };
        let (x, y, z) = (insert.x_scale_factor, insert.y_scale_factor, insert.z_scale_factor);
        if !(x != 0.0 && y != 0.0 && [x, y, z].iter().all(|scale| scale.is_finite())) {
            return Ok(Err(Reason::Degenerate));
        }
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), insert.rotation.to_radians());
        let (base, to) = (&block.base_point, &insert.location);
        let from_base = scaling(x, y, z) * Translation3::new(-base.x, -base.y, -base.z);
        let outside = outer.map * frame * Translation3::new(to.x, to.y, to.z) * turn;
        for row in 0..insert.row_count.max(1) {
            for column in 0..insert.column_count.max(1) {
                self.add(1)?;
                let (along, across) = (f64::from(column), f64::from(row));
                let step = Translation3::new(
                    along * insert.column_spacing,
                    across * insert.row_spacing,
                    0.0,
                );
                let map = outside * step * from_base;
                let inner = Insertion { map, depth: outer.depth + 1, ..outer };
                self.entities(block.entities.iter(), items, inner)?;
            }
        }
        Ok(Ok(()))
    }

    fn add(&mut self, count: usize) -> Result<(), DxfReadError> {
        self.count = self.count.saturating_add(count);
        let limit = self.limits.pieces;
        if self.count > limit { Err(DxfReadError::TooMany(limit)) } else { Ok(()) }
    }
}

/// Checks that the crate has read everything in the file.
fn complete<'e>(
    entities: impl Iterator<Item = &'e Entity>,
    items: &Items,
) -> Result<(), DxfReadError> {
    let expected = items.understood.len();
    let mut found = 0;
    for (entity, (kind, _)) in entities.zip(&items.understood) {
        let same = match &entity.specific {
            EntityType::Line(_) => *kind == "LINE",
            EntityType::Arc(_) => *kind == "ARC",
            EntityType::Circle(_) => *kind == "CIRCLE",
            EntityType::LwPolyline(_) => *kind == "LWPOLYLINE",
            EntityType::Polyline(_) => *kind == "POLYLINE",
            EntityType::Ellipse(_) => *kind == "ELLIPSE",
            EntityType::Spline(_) => *kind == "SPLINE",
            EntityType::Insert(_) => *kind == "INSERT",
            _ => false,
        };
        found += usize::from(same);
    }
    if found == expected { Ok(()) } else { Err(DxfReadError::Incomplete { expected, found }) }
}
