//! Motors, drives and payload of a machine as JSON.

use crate::check::wire_rates;
use serde_json::{Value, json};
use twin_machine::{Axis, DeviceEntry, DriveFamily, FeedForward, Machine, SimulatedMotor};

/// Motor of an axis of the simulated machine: efforts in N or Nm, friction and inertia at the axis.
pub(super) fn motor(axis: &Axis) -> Value {
    let simulated = &axis.simulated;
    let kind = match &simulated.motor {
        SimulatedMotor::Servo(servo) => json!({
            "kind": "servo",
            "bandwidth_hz": simulated.bandwidth_hz,
            "feed_forward": match servo.effort_feed_forward {
                FeedForward::None => "none",
                FeedForward::Inertia => "inertia",
                FeedForward::Dynamics => "dynamics",
            },
        }),
        SimulatedMotor::Stepper(stepper) => json!({
            "kind": "stepper",
            "full_step": axis.from_si(stepper.full_step),
            "microsteps": stepper.microsteps,
        }),
    };
    let between = simulated.transmission.map(|elastic| {
        json!({
            "stiffness": elastic.stiffness * axis.kind.scale(),
            "backlash": axis.from_si(elastic.backlash),
        })
    });
    let mut motor = json!({
        "effort_unit": axis.kind.effort_unit(),
        "effort_limit": axis.effort_limit(),
        "dry_friction": simulated.dry_friction(),
        "viscous_friction": simulated.viscous_friction() * axis.kind.scale(),
        "inertia": simulated.armature,
        "transmission": between,
        "brake": simulated.brake.is_some(),
    });
    if let (Value::Object(motor), Value::Object(kind)) = (&mut motor, kind) {
        motor.extend(kind);
    }
    motor
}

/// Drive of an axis, and the axis of that drive.
pub(super) fn of_axis(machine: &Machine, axis: &Axis) -> Option<Value> {
    let drive = axis.drive.as_ref()?;
    let device = machine.drives.get(drive.device)?;
    Some(json!({
        "name": device.name,
        "axis": device.axis_name(drive.index),
        "increments": drive.ratio.increments,
        "per_units": drive.ratio.per_units,
    }))
}

/// The devices on the wires, and what these carry.
pub(super) fn drives(machine: &Machine) -> Vec<Value> {
    let rates = wire_rates(machine);
    let carries = |index| {
        let (_, rates) = rates.iter().find(|(of, _)| *of == index)?;
        Some(json!({
            "commands_per_s": rates.commands_per_s,
            "samples_per_s": rates.samples_per_s,
        }))
    };
    let one = |(index, device): (usize, &DeviceEntry)| {
        let mut object = json!({
            "name": device.name,
            "family": device.family_name(),
            "port": device.port,
            "in_loop": device.in_loop,
            "wire": carries(index),
        });
        let more = match device.family() {
            DriveFamily::InterpCnc(board) => {
                let encoder = board.encoder.map(|encoder| {
                    json!({
                        "axis": device.axis_name(encoder.axis.index()),
                        "points": encoder.points,
                        "per_increments": encoder.increments,
                        "tolerance_increments": encoder.tolerance,
                    })
                });
                json!({ "station": board.address, "baud": board.baud, "encoder": encoder })
            }
            DriveFamily::SmartDrive(bus) => json!({ "microsteps_per_turn": bus.turn.get() }),
            DriveFamily::Bim2Ax(module) => {
                let encoder = module.encoder.as_ref().map(|encoder| {
                    let axes = encoder.axes.iter().map(|axis| axis.number());
                    json!({
                        "axes": axes.collect::<Vec<_>>(),
                        "points_per_turn": encoder.points_per_turn,
                        "increments_per_turn": encoder.increments_per_turn,
                        "tolerance_increments": encoder.tolerance,
                    })
                });
                json!({ "microsteps_per_step": module.mode.microsteps(), "encoder": encoder })
            }
            DriveFamily::Other => json!({}),
        };
        if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
            object.extend(more);
        }
        object
    };
    machine.drives.iter().enumerate().map(one).collect()
}

/// Payload of the tool.
pub(super) fn payload(machine: &Machine) -> Option<Value> {
    machine.payload.as_ref().map(|payload| {
        let center = [payload.center.x, payload.center.y, payload.center.z];
        json!({ "mass_kg": payload.mass, "center_mm": center.map(|value| value * 1e3) })
    })
}
