//! Actions of `twin drive`, the same for every family.

use super::by_switch::BySwitch;
use super::consent::{Beforehand, Consent};
use super::family::Family;
use super::on_file::OnFile;
use crate::command::assume::Assume;
use crate::command::{Failure, Status, show};

/// What is asked of a device of a family.
#[derive(Debug, clap::Args)]
pub(super) struct Command<F: Family> {
    #[command(flatten)]
    pub(super) line: F::Line,

    #[command(flatten)]
    consent: Beforehand,

    #[command(flatten)]
    pub(super) assume: Assume,

    #[command(subcommand)]
    pub(super) action: Action<F>,
}

/// What is done with a device.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Action<F: Family> {
    /// Look who answers; changes nothing
    Scan(F::Scan),
    /// Show the state of the device and the positions of its axes; changes nothing
    Status,
    /// Make the device obey and give its motors current; nothing moves
    ///
    /// An InterpCNC: clear "Board Locked" and the errors of homing and probing. A SmartDRIVE: mode 3, position 0, alarms
    /// cleared; one that is in mode 3 already keeps its position. A BIM2AX: current, after a motor test where the module does
    /// not know that order.
    Unlock(F::Unlock),
    /// Let axes search their home switches, as the parameters of the device say (asks first)
    Home {
        #[command(flatten)]
        home: F::Home,

        #[command(flatten)]
        by_switch: BySwitch,

        #[command(flatten)]
        consent: Consent,
    },
    #[command(flatten)]
    OnFile(OnFile),
    /// Move one axis by a distance (asks first)
    Jog {
        #[command(flatten)]
        axis: F::Axis,

        /// Increments: steps, µsteps; below 0: backwards
        #[arg(allow_negative_numbers = true, value_name = "DISTANCE")]
        distance: i32,

        #[command(flatten)]
        ramps: F::Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Move one axis to a position (asks first)
    Move {
        #[command(flatten)]
        axis: F::Axis,

        /// Where to, increments: steps, µsteps
        #[arg(allow_negative_numbers = true, value_name = "POSITION")]
        position: i32,

        #[command(flatten)]
        ramps: F::Ramps,

        #[command(flatten)]
        consent: Consent,
    },
    /// Bring all axes to rest on their ramps
    Stop {
        /// At once: an InterpCNC is locked then and may lose steps, a SmartDRIVE is off and a load may run on or fall, a BIM2AX
        /// has to be homed
        #[arg(long)]
        now: bool,
    },
    /// Show a parameter, or all of them
    Get {
        /// Name or number
        parameter: Option<String>,
    },
    /// Change a parameter, at rest
    ///
    /// An InterpCNC and a BIM2AX keep it in their EEPROM at once, a SmartDRIVE when `save` says so.
    Set {
        /// Name or number
        parameter: String,

        /// New value, decimal or hexadecimal (0x1F, $1F)
        #[arg(allow_negative_numbers = true)]
        value: String,
    },
    /// Make the device keep its parameters over a restart; the position of a SmartDRIVE becomes 0
    Save,
    /// Restart the device, after which all parameters act: positions and homing are lost, motors get no current
    Reset,
    /// Show inputs
    Inputs,
    /// Show outputs, after switching or setting some
    Outputs(F::Outputs),
}

impl<F: Family> Command<F> {
    /// Carries the action out.
    pub(super) fn run(&self) -> Result<Status, Failure> {
        let refused = match &self.action {
            Action::Scan(scan) => return F::scan(self, scan),
            Action::OnFile(on_file) => {
                let restore = matches!(on_file, OnFile::Restore { .. });
                on_file.carry_out(&mut *F::drive(self, restore)?, self.consent())?;
                return Ok(Status::Fit);
            }
            Action::Home { home, by_switch, .. } if by_switch.is_wanted() => {
                F::home_by_switch(self, home, by_switch)?;
                return Ok(Status::Fit);
            }
            Action::Save => {
                if let Some(words) = F::KEEPS {
                    say!("{words}");
                    return Ok(Status::Fit);
                }
                None
            }
            Action::Reset => F::NO_RESET,
            Action::Outputs(_) => F::NO_OUTPUTS,
            _ => None,
        };
        if let Some(words) = refused {
            return Err(Failure::Usage(words.to_owned()));
        }
        let mut device = F::open(self)?;
        if let Some(status) = device.prepare(self)? {
            return Ok(status);
        }
        match &self.action {
            Action::Scan(_) | Action::OnFile(_) => {}
            Action::Status => device.status()?,
            Action::Unlock(unlock) => device.unlock(unlock)?,
            Action::Home { home, .. } => device.home(home)?,
            Action::Jog { axis, distance, ramps, .. } => {
                self.travel(&mut device, (axis, ramps), &|from| {
                    from.checked_add(*distance).ok_or_else(|| {
                        let (name, unit) = (F::axis_name(axis), F::UNIT);
                        let message =
                            format!("{name} at {from} cannot go {distance} {unit} further");
                        Failure::Usage(message)
                    })
                })?;
            }
            Action::Move { axis, position, ramps, .. } => {
                self.travel(&mut device, (axis, ramps), &|_| Ok(*position))?;
            }
            Action::Stop { now } => say!("{}", device.stop(*now)?),
            Action::Get { parameter } => get(&mut device, parameter.as_deref())?,
            Action::Set { parameter, value } => device.set(&F::find(parameter)?, value)?,
            Action::Save => device.save()?,
            Action::Reset => return device.reset(),
            Action::Inputs => device.inputs()?,
            Action::Outputs(outputs) => device.outputs(outputs)?,
        }
        Ok(Status::Fit)
    }

    /// Whether what the action asks about may be done.
    pub(super) fn consent(&self) -> Consent {
        self.consent.or(match &self.action {
            Action::Home { consent, .. }
            | Action::Jog { consent, .. }
            | Action::Move { consent, .. } => Some(*consent),
            Action::OnFile(on_file) => on_file.consent(),
            _ => None,
        })
    }

    fn travel(
        &self,
        device: &mut F,
        (axis, ramps): (&F::Axis, &F::Ramps),
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<(), Failure> {
        let travel = device.plan(axis, ramps, target)?;
        self.consent().ask(&travel.question)?;
        device.travel(axis, &travel)?;
        say!("{} is at {}", F::axis_name(axis), travel.target);
        device.report_follower()
    }
}

fn get<F: Family>(device: &mut F, wanted: Option<&str>) -> Result<(), Failure> {
    let wanted = match wanted {
        Some(text) => vec![F::find(text)?],
        None => F::parameters(),
    };
    let mut table = show::table();
    table.set_header(F::COLUMNS.iter().copied());
    for parameter in &wanted {
        table.add_row(device.row(parameter)?);
    }
    say!("{table}");
    Ok(())
}
