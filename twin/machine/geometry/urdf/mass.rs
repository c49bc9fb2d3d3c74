//! Masses of URDF links that have none in the URDF.

use crate::section::Section;
use std::ops::RangeInclusive;
use twin_urdf::{JointKind, Model};

/// Masses in kg.
const MASS_KG: RangeInclusive<f64> = 1e-6..=100_000.0;

/// `density_kg_per_m3` and `[body.links.NAME] mass_kg`.
pub(super) struct Masses {
    density: Option<f64>,
    links: Vec<(String, f64)>,
}

impl Masses {
    pub(super) fn read(body: &Section<'_>) -> Self {
        let links = body.section("links");
        let mut masses = Vec::new();
        for name in links.keys() {
            let link = links.section(name);
            if let Some(mass) = link.required_number("mass_kg", MASS_KG) {
                masses.push((name.to_owned(), mass));
            }
            link.finish();
        }
        Self { density: body.number("density_kg_per_m3", 1.0..=50_000.0), links: masses }
    }

    /// Sets masses: first those of named links, then by density those of moving links with solids.
    pub(super) fn complete(&self, model: &mut Model, body: &Section<'_>) -> Option<()> {
        let named = body.section("links");
        let mut complete = true;
        for (name, mass) in &self.links {
            let Some(link) = model.links.iter_mut().find(|link| link.name == *name) else {
                complete = false;
                named.complain_at(name, format!("the URDF has no link {name}"));
                continue;
            };
            // As it is distributed there.
            let given = link.inertial.map(|given| {
                let inertia = given.inertia * (mass / given.mass);
                twin_urdf::Inertial { mass: *mass, inertia, ..given }
            });
            link.inertial = Some(given.unwrap_or_else(|| link.uniform_of(*mass)));
        }
        let moves = moving_links(model);
        let lacking = model.links.iter_mut().zip(moves);
        let lacking = lacking.filter(|(link, moves)| *moves && link.inertial.is_none());
        for (link, _) in lacking {
            let Some(density) = self.density else { continue };
            if link.solids.is_empty() && link.collision.is_empty() {
                continue;
            }
            link.inertial = link.uniform_at(density);
            if link.inertial.is_none() {
                complete = false;
                let message = format!(
                    "the mesh of link {} encloses no volume, so that its mass does not follow from its density",
                    link.name
                );
                let help = format!("give [body.links.{}] mass_kg", link.name);
                body.complain_with_help("density_kg_per_m3", message, Some(help));
            }
        }
        complete.then_some(())
    }
}

/// True for each link that an axis moves.
pub(crate) fn moving_links(model: &Model) -> Vec<bool> {
    // A parent comes before its children.
    let mut moves = vec![false; model.links.len()];
    for joint in &model.joints {
        let moved =
            joint.kind != JointKind::Fixed || moves.get(joint.parent).copied().unwrap_or_default();
        if let Some(slot) = moves.get_mut(joint.child) {
            *slot = moved;
        }
    }
    moves
}
