//! Property tests of forward and inverse dynamics against each other and against rapier, on arbitrary trees.

use proptest::prelude::*;

use super::*;

/// A tree of 1 to 8 links with arbitrary frames, directions, masses and order of axes, and a joint motion.
#[derive(Clone, Debug)]
struct Case {
    model: Model,
    position: AxisVector,
    velocity: AxisVector,
    acceleration: AxisVector,
}

fn cases() -> impl Strategy<Value = Case> {
    let link = (
        any::<bool>(),
        prop::array::uniform3(-1.0..1.0_f64),
        prop::array::uniform6(-1.0..1.0_f64),
        (0.5..5.0_f64, prop::array::uniform3(-0.3..0.3_f64), prop::array::uniform3(0.05..0.4_f64)),
        prop::array::uniform3(-2.0..2.0_f64),
        any::<prop::sample::Index>(),
    );
    (prop::collection::vec(link, 1..=MAX_AXES), 0..MAX_AXES).prop_map(|(links, shift)| {
        let count = links.len();
        let mut model = chain([]);
        for (index, (revolute, direction, frame, (mass, center, size), _, parent)) in
            links.iter().enumerate()
        {
            let [x, y, z, a, b, c] = *frame;
            let kind = if *revolute { JointKind::Revolute } else { JointKind::Prismatic };
            let origin = Isometry3::new(Vector3::new(x, y, z), Vector3::new(a, b, c) * 2.0);
            // Not too near to zero to have a direction.
            let direction = Vector3::from(*direction) + Vector3::new(0.0, 0.0, 1.5);
            let mut piece =
                chain([(kind, direction, origin, Some(uniform_box(*mass, *center, *size)))]);
            let mut joint = piece.joints.remove(0);
            joint.parent = parent.index(index + 1);
            joint.child = index + 1;
            joint.drive = JointDrive::Axis((index + shift) % count);
            model.joints.push(joint);
            model.links.push(piece.links.remove(1));
        }
        let motion = |which: usize| AxisVector::from_values(links.iter().map(|link| link.4[which]));
        Case { model, position: motion(0), velocity: motion(1), acceleration: motion(2) }
    })
}

proptest! {
    /// The efforts that inverse dynamics asks for an acceleration give that acceleration, rotors included.
    #[test]
    fn forward_dynamics_undoes_inverse_dynamics(case in cases(), armature in 0.0..1.0_f64) {
        let count = case.position.len();
        let armature = axis_vector(&JointVector::repeat(armature), count);
        let [q, v, a, armature] =
            [case.position, case.velocity, case.acceleration, armature].map(|values| joint_vector(values.iter().copied()));
        let mut dynamics = Dynamics::new(&case.model, count, down(), armature).unwrap();
        let effort = dynamics.inverse_dynamics(&q, &v, &a);
        let back = dynamics.acceleration(&q, &v, &effort).unwrap();
        prop_assert!((back - a).amax() < 1e-6, "{} instead of {}", back, a);
        prop_assert!(effort.amax() > 1e-3, "nothing to do: {}", effort);
    }

    /// The power of the efforts is the rate of the energy (central difference): gravity, Coriolis terms and inertia
    /// have the signs and sizes they must have.
    #[test]
    fn effort_is_power(case in cases()) {
        let count = case.position.len();
        let [q, v, a] =
            [case.position, case.velocity, case.acceleration].map(|values| joint_vector(values.iter().copied()));
        let mut dynamics = Dynamics::new(&case.model, count, down(), JointVector::zeros()).unwrap();
        let power = dynamics.inverse_dynamics(&q, &v, &a).dot(&v);
        let h = 1e-4;
        let mut unfolded = Unfolded::new(&case.model, count, down(), JointVector::zeros());
        let mut energy = |t: f64| {
            let (kinetic, potential) = unfolded.energy(&(q + v * t + a * (0.5 * t * t)), &(v + a * t));
            kinetic + potential
        };
        let rate = (energy(h) - energy(-h)) / (2.0 * h);
        let scale = 1.0 + energy(0.0).abs();
        prop_assert!((power - rate).abs() < 1e-3 * scale, "{power} W, but the energy grows with {rate} W");
    }

    /// rapier, given the bias efforts, leaves the velocity alone on every tree: same frames, masses and axes.
    #[test]
    fn rapier_agrees_about_the_bias(case in cases()) {
        let count = case.position.len();
        let [q, v] = [case.position, case.velocity].map(|values| joint_vector(values.iter().copied()));
        let mut dynamics = Dynamics::new(&case.model, count, down(), JointVector::zeros()).unwrap();
        let zero = JointVector::zeros();
        let equation = Equation::new(&case.model, count, down(), zero).unwrap();
        let mut world = RapierAlone::new(&case.model, &equation, down(), (&zero, &q), (1e-3, 1));
        world.set_velocity(&v);
        world.apply_effort(&dynamics.inverse_dynamics(&q, &v, &JointVector::zeros()));
        world.step();
        let (position, velocity) = world.motion();
        prop_assert!((velocity - v).amax() < 1e-9, "{velocity} instead of {v}");
        prop_assert!((position - (q + v * 1e-3)).amax() < 1e-12);
    }
}
