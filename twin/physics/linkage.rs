//! Tripod recognition in a model with closed loops.

use nalgebra::{Matrix3, Point3, Vector3};
use twin_kinematics::tripod::{Tripod, TripodDeviations, TripodDimensions};
use twin_urdf::{Joint, JointDrive, JointKind, Loop, Model};

use crate::bodies::{MassProperties, Tree};
use crate::error::{PhysicsError, Result};

/// Tolerance of rounding, relative to a length, an inertia, or 1.
const ROUNDING: f64 = 1e-9;

/// Rods whose lengths and places differ by no more of a length are alike.
const EQUAL: f64 = 1e-13;

/// A carriage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carriage {
    pub(super) axis: usize,
    pub(super) mass: f64,
}

/// A rod and its mass properties.
#[derive(Clone, Copy, Debug)]
pub(super) struct RodBody {
    /// 0 to 2.
    pub(super) carriage: usize,
    /// Its upper end with its carriage at 0, machine frame.
    pub(super) upper: Point3<f64>,
    /// Its lower end in the frame of the platform.
    pub(super) lower: Point3<f64>,
    pub(super) length: f64,
    /// m₁₁, m₁₂ and m₂₂, kg.
    pub(super) masses: [f64; 3],
    /// Parts of its mass at its upper and at its lower end, kg.
    pub(super) shares: [f64; 2],
}

/// The parts of a tripod.
pub(super) struct Linkage {
    pub(super) carriages: [Carriage; 3],
    /// Two of each carriage, in their order.
    pub(super) rods: [RodBody; 6],
    pub(super) platform: MassProperties,
    /// Links that have nothing to do with it.
    pub(super) others: Option<Tree>,
}

/// A rod as the model has it.
pub(super) struct Hanging<'m> {
    pub(super) slide: &'m Joint,
    /// Its first joint; the origin of this joint is the upper end.
    pub(super) swing: &'m Joint,
    /// Its second joint; its child is the rod.
    pub(super) tilt: &'m Joint,
    /// Its lower end in its own frame, and in that of the platform.
    pub(super) ends: [Point3<f64>; 2],
}

impl Linkage {
    /// Tripod in `model`: carriages that slide upwards, rods on them by two passive joints in one point, the
    /// platform on the first rod by three joints, held to the others by [loops](Model::loops).
    /// Errors: [`PhysicsError::UnknownMechanism`], [`PhysicsError::UnevenRod`], [`PhysicsError::MassProperties`].
    pub(super) fn of(model: &Model, axis_count: usize) -> Result<Self> {
        let unknown = PhysicsError::UnknownMechanism(model.loops.len());
        let hanging = hanging(model).ok_or(unknown)?;
        let mut carriages: Vec<(Carriage, usize)> = Vec::new();
        let mut rods = Vec::with_capacity(hanging.len());
        for rod in &hanging {
            let known = carriages.iter().position(|(_, link)| *link == rod.slide.child);
            let carriage = known.unwrap_or(carriages.len());
            if known.is_none() {
                let axis = rod.slide.drive.axis().filter(|axis| *axis < axis_count);
                let link = model.links.get(rod.slide.child).ok_or(unknown)?;
                let MassProperties { mass, .. } = MassProperties::of(rod.slide.child, link)?;
                carriages.push((Carriage { axis: axis.ok_or(unknown)?, mass }, rod.slide.child));
            }
            rods.push(rod.body(model, carriage)?);
        }
        rods.sort_by_key(|rod| rod.carriage);
        let platform = platform(model).ok_or(unknown)?;
        let link = model.links.get(platform).ok_or(unknown)?;
        let carriages: Vec<Carriage> =
            carriages.into_iter().map(|(carriage, _)| carriage).collect();
        Ok(Self {
            carriages: carriages.try_into().map_err(|_other| unknown)?,
            rods: rods.try_into().map_err(|_other| unknown)?,
            platform: MassProperties::of(platform, link)?,
            others: others(model, axis_count)?,
        })
    }
}

impl Hanging<'_> {
    fn body(&self, model: &Model, carriage: usize) -> Result<RodBody> {
        let unknown = PhysicsError::UnknownMechanism(model.loops.len());
        let number = self.tilt.child;
        let link = model.links.get(number).ok_or(unknown)?;
        let MassProperties { mass, center, inertia } = MassProperties::of(number, link)?;
        let [end, lower] = self.ends;
        let length = end.coords.norm();
        let along = end.coords / length;
        let part = center.coords.dot(&along) / length;
        let about = along.dot(&(inertia * along));
        let across = 0.5 * (inertia.trace() - about);
        let turned = along * along.transpose();
        let even = (Matrix3::identity() - turned) * across + turned * about;
        if (center.coords - end.coords * part).norm() > ROUNDING * length
            || (inertia - even).amax() > ROUNDING * inertia.amax()
        {
            return Err(PhysicsError::UnevenRod(number));
        }
        let turning = across / (length * length);
        let (above, below) = (1.0 - part, part);
        let upper = self.slide.origin * Point3::from(self.swing.origin.translation.vector);
        Ok(RodBody {
            carriage,
            upper,
            lower,
            length,
            masses: [
                mass * above * above + turning,
                mass * above * below - turning,
                mass * below * below + turning,
            ],
            shares: [mass * above, mass * below],
        })
    }
}

/// The joints from the base to `link`.
pub(super) fn chain(model: &Model, mut link: usize) -> Vec<&Joint> {
    let mut chain = Vec::new();
    while let Some(joint) = link.checked_sub(1).and_then(|index| model.joints.get(index)) {
        chain.push(joint);
        // A parent has a smaller index than its child, so this ends.
        if joint.child != link || joint.parent >= link {
            break;
        }
        link = joint.parent;
    }
    chain.reverse();
    chain
}

/// The link that all loops close at.
pub(super) fn platform(model: &Model) -> Option<usize> {
    let [Loop { links: [_, platform], .. }, ..] = model.loops.as_slice() else { return None };
    let same = model.loops.iter().all(|closing| closing.links[1] == *platform);
    same.then_some(*platform)
}

/// All rods, first the one that carries the platform. `None` if the model is not a tripod.
pub(super) fn hanging(model: &Model) -> Option<Vec<Hanging<'_>>> {
    let platform = platform(model)?;
    let in_place = |joint: &&Joint| joint.origin.translation.vector.norm() <= ROUNDING;
    let turns = |joint: &&Joint| {
        joint.kind == JointKind::Revolute && matches!(joint.drive, JointDrive::Passive { .. })
    };
    let on_carrier = chain(model, platform);
    let (upper, on_rod) = on_carrier.split_at_checked(3)?;
    let [.., carrier] = upper else { return None };
    let (ball, fixed) = on_rod.split_at_checked(3)?;
    let [first, further @ ..] = ball else { return None };
    let free = ball.iter().all(turns) && further.iter().all(in_place);
    let to_platform = match fixed {
        [] => nalgebra::Isometry3::identity(),
        [joint] if joint.kind == JointKind::Fixed => joint.origin,
        _ => return None,
    };
    if !free {
        return None;
    }
    // Where the ball is, seen from the platform.
    let ball = to_platform.inverse() * Point3::origin();
    let ends = [Point3::from(first.origin.translation.vector), ball];
    let others = model.loops.iter().map(|closing| (closing.links[0], closing.points));
    let rods = std::iter::once((carrier.child, ends)).chain(others);
    rods.map(|(link, ends)| {
        let chain = chain(model, link);
        let [slide, swing, tilt] = chain.as_slice() else { return None };
        let upwards = slide.origin.rotation * slide.axis.into_inner() - Vector3::z();
        let slides = slide.kind == JointKind::Prismatic
            && slide.parent == 0
            && slide.drive.axis().is_some()
            && upwards.norm() <= ROUNDING;
        let hangs = turns(swing)
            && turns(tilt)
            && in_place(tilt)
            && swing.axis.dot(&tilt.axis).abs() <= ROUNDING;
        let massless = model.links.get(swing.child)?.inertial.is_none();
        (slides && hangs && massless).then_some(Hanging { slide, swing, tilt, ends })
    })
    .collect()
}

/// The links on other axes than those of the tripod's carriages.
fn others(model: &Model, axis_count: usize) -> Result<Option<Tree>> {
    let mut within = vec![false; model.links.len()];
    for closing in &model.loops {
        for link in closing.links {
            for joint in chain(model, link) {
                if let Some(slot) = within.get_mut(joint.child) {
                    *slot = true;
                }
            }
        }
    }
    let mut rest =
        Model { links: Vec::new(), joints: Vec::new(), loops: Vec::new(), ..model.clone() };
    rest.links.extend(model.links.first().cloned());
    let mut numbers = vec![0; model.links.len()];
    // What they are in the whole model.
    let (mut joints, mut links) = (Vec::new(), vec![0]);
    for (index, joint) in model.joints.iter().enumerate() {
        if within.get(joint.child).copied().unwrap_or_default() {
            continue;
        }
        let child = rest.links.len();
        let parent = numbers.get(joint.parent).copied().unwrap_or_default();
        if let (Some(link), Some(number)) =
            (model.links.get(joint.child), numbers.get_mut(joint.child))
        {
            *number = child;
            rest.links.push(link.clone());
            rest.joints.push(Joint { parent, child, ..joint.clone() });
            links.push(joint.child);
            joints.push(index);
        }
    }
    // Joint i moves link i + 1, before and after.
    for (index, joint) in rest.joints.iter_mut().enumerate() {
        if let JointDrive::Mimic { joint: leader, .. } = &mut joint.drive {
            let number = numbers.get(*leader + 1).and_then(|number| number.checked_sub(1));
            let coupled = PhysicsError::CoupledJoint(index);
            *leader = number.ok_or_else(|| coupled.renumbered(&joints, &links))?;
        }
    }
    if rest.joints.is_empty() {
        return Ok(None);
    }
    let tree = Tree::new(&rest, axis_count);
    tree.map(Some).map_err(|error| error.renumbered(&joints, &links))
}

/// The tripod of level pairs that these are, if they are.
pub(super) fn level_tripod(rods: &[RodBody; 6]) -> Option<Tripod> {
    let beyond = |rod: &RodBody| rod.upper - rod.lower;
    let [first, ..] = rods;
    let [x, y, z]: [f64; 3] = beyond(first).into();
    let dimensions = TripodDimensions {
        inner_radius: 0.0,
        outer_radius: x.hypot(y),
        rod_length: first.length,
        rod_distance: 0.0,
        rotation: y.atan2(x),
    };
    let tripod = Tripod::new(dimensions, [-z; 3]).ok()?;
    let designed = dimensions.rods(&TripodDeviations::default()).ok()?;
    let same = rods.iter().zip(&designed).all(|(rod, designed)| {
        let apart = beyond(rod) - (designed.upper - designed.lower) - Vector3::z() * z;
        apart.norm().max((rod.length - first.length).abs()) <= EQUAL * first.length
    });
    same.then_some(tripod)
}
