//! SCARAs: arms that turn about vertical axes.

use super::design::{
    ANGLE_DEG, AtZero, DEG, DEVIATION_DEG, DEVIATION_MM, Design, Fit, FittedKey, Kind, LENGTH_MM,
    MM, Mounted, Sections, added, length, mass, masses, numbers,
};
use super::rounded;
use crate::axis_kind::AxisKind::Rotary;
use crate::section::Section;
use nalgebra::Vector3;
use twin_kinematics::scara::{Elbow, Scara2, Scara3};
use twin_kinematics::{DimensionError, Kinematics};
use twin_urdf::{Model, ScaraDimensions, ScaraHand};

pub(super) const KINDS: &[Kind] = &[
    Kind {
        name: "scara2",
        outputs: &[("A", Rotary), ("B", Rotary)],
        moves_z: false,
        has_table: false,
        turns_tool: false,
        beyond_urdf: None,
        read: |sections| read(sections, 2),
    },
    Kind {
        name: "scara3",
        outputs: &[("A", Rotary), ("B", Rotary), ("C", Rotary)],
        moves_z: false,
        has_table: false,
        turns_tool: true,
        beyond_urdf: None,
        read: |sections| read(sections, 3),
    },
];

#[derive(Clone, Debug)]
struct Scara {
    arms: [f64; 3],
    offsets: [f64; 3],
    elbow: Elbow,
    has_hand: bool,
    /// Masses and sizes, as far as the file says.
    sizes: ScaraDimensions,
    /// kg.
    hand_mass: Option<f64>,
}

fn read(sections: &Sections<'_>, count: usize) -> Option<Box<dyn Design>> {
    let Sections { nominal, deviations, body } = sections;
    let arms = if count == 2 {
        let arms = nominal.required_numbers::<2>("arm_lengths_mm", LENGTH_MM);
        arms.map(|[first, second]| [first, second, 0.0])
    } else {
        // The third may be 0: the hand then only turns.
        let arms = nominal.required_numbers::<3>("arm_lengths_mm", 0.0..=*LENGTH_MM.end());
        for arm in arms.into_iter().flatten().take(2).filter(|arm| !LENGTH_MM.contains(arm)) {
            let (low, high) = (LENGTH_MM.start(), LENGTH_MM.end());
            let message = format!("arms are {arm} mm long; the first two are {low} to {high} mm");
            nominal.complain_at("arm_lengths_mm", message);
        }
        arms
    };
    let offsets = numbers(nominal, "offsets_deg", ANGLE_DEG, count).unwrap_or_default();
    let elbow = nominal.choice("elbow", &[("low", Elbow::Low), ("high", Elbow::High)]);
    let measured_arms = numbers(deviations, "arm_lengths_mm", DEVIATION_MM, count);
    let measured_offsets = numbers(deviations, "offsets_deg", DEVIATION_DEG, count);
    let hand = body.filter(|_| count == 3);
    let hand_mass = hand.and_then(|body| mass(body, "hand_mass_kg"));
    let sizes = body.map(sizes).unwrap_or_default();
    Some(Box::new(Scara {
        arms: added(arms?, measured_arms, MM),
        offsets: added(offsets, measured_offsets, DEG),
        elbow: elbow.unwrap_or(Elbow::Low),
        has_hand: count == 3,
        sizes,
        hand_mass,
    }))
}

fn sizes(body: &Section<'_>) -> ScaraDimensions {
    let widths = body.numbers::<2>("arm_widths_mm", LENGTH_MM);
    let heights = body.numbers::<2>("arm_heights_mm", LENGTH_MM);
    if widths.is_some() != heights.is_some() {
        body.complain("`arm_widths_mm` and `arm_heights_mm` are given together or not at all");
    }
    let arm_sections =
        widths.zip(heights).map(|([w1, w2], [h1, h2])| [[w1 * MM, h1 * MM], [w2 * MM, h2 * MM]]);
    ScaraDimensions {
        arm_masses: masses(body, "arm_masses_kg"),
        arm_sections,
        quill_mass: mass(body, "quill_mass_kg"),
        quill_length: length(body, "quill_length_mm"),
        column_height: length(body, "column_height_mm"),
        ..ScaraDimensions::default()
    }
}

impl Design for Scara {
    fn transform(&self) -> Result<Box<dyn Kinematics>, DimensionError> {
        let ([first, second, _], [a, b, _]) = (self.arms, self.offsets);
        Ok(if self.has_hand {
            Box::new(Scara3::new(self.arms, self.offsets, self.elbow)?)
        } else {
            Box::new(Scara2::new([first, second], [a, b], self.elbow)?)
        })
    }

    fn model(&self, mounted: &Mounted<'_>) -> Option<Result<Model, twin_urdf::DimensionError>> {
        let Mounted { name, joint, tool } = mounted;
        let ([first, second, third], [a, b, c]) = (self.arms, self.offsets);
        let hand = if self.has_hand {
            let hand = ScaraHand::new(joint("C")?, third);
            Some(ScaraHand { offset: c, mass: self.hand_mass, ..hand })
        } else {
            None
        };
        let dimensions = ScaraDimensions {
            name: (*name).to_owned(),
            arm_joints: [joint("A")?, joint("B")?],
            quill_joint: joint("Z"),
            arms: [first, second],
            offsets: [a, b],
            hand,
            tool: tool.tip,
            tool_mass: tool.mass,
            tool_radius: tool.radius(),
            ..self.sizes.clone()
        };
        Some(dimensions.model())
    }

    fn fit(&self, urdf: &AtZero<'_>) -> Option<Fit> {
        let flange = urdf.flange;
        let [a, b] = [(urdf.joint)("A")?, (urdf.joint)("B")?];
        let wrist = if self.has_hand { (urdf.joint)("C")? } else { flange };
        let count = if self.has_hand { 3 } else { 2 };
        let legs = [b - a, wrist - b, flange - wrist].map(|leg| leg.xy());
        let lengths = legs.map(|leg| rounded(leg.norm() * 1e3));
        let mut before = 0.0;
        let mut turns = legs.map(|leg| {
            // A leg of no length goes on as the one before.
            let direction = if leg.norm() > 1e-9 { leg.y.atan2(leg.x) } else { before };
            let turn = direction - before;
            before = direction;
            let turn = (0.0 - turn).to_degrees();
            rounded(turn - 360.0 * (turn / 360.0).round())
        });
        // A hand of no length turns the tool from where it is.
        if self.has_hand && lengths[2] < 1e-6 {
            turns[2] = rounded(self.offsets[2].to_degrees());
        }
        let key = |key, fitting: [f64; 3], present: [f64; 3]| {
            let [fitting, present] =
                [fitting, present].map(|values| values.into_iter().take(count).collect());
            FittedKey { key, fitting, present }
        };
        Some(Fit {
            keys: vec![
                key("arm_lengths_mm", lengths, self.arms.map(|arm| arm * 1e3)),
                key("offsets_deg", turns, self.offsets.map(f64::to_degrees)),
            ],
            shift: -Vector3::new(a.x, a.y, flange.z),
            design: Box::new(Self {
                arms: lengths.map(|length| length * MM),
                offsets: turns.map(f64::to_radians),
                ..self.clone()
            }),
        })
    }
}
