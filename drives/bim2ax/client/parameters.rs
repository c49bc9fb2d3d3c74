//! Parameters and RESET.

use tokio::time::{sleep, timeout};

use super::{
    Action, Bim2Ax, Clock, DriveError, ModuleAxis, ParameterExchange, ReadZone, WriteZone, card,
};
use crate::{
    AxisSettings, DriveMode, Fault, REFERENCES,
    protocol::parameter::{AxisParameter, Parameter, order},
};
use twin_drives::ProtocolFault;

impl Bim2Ax {
    /// Writes the zone "Paramètre" and gives the answer.
    async fn parameter_exchange(
        &mut self,
        action: Action,
        asked: ParameterExchange,
        clock: &dyn Clock,
    ) -> Result<ParameterExchange, DriveError> {
        let byte_order = self.options.byte_order;
        self.settle().await;
        let (bytes, _) = self
            .write(
                action,
                WriteZone::Parameter,
                &asked.encode(byte_order),
                ReadZone::Parameter,
                clock,
            )
            .await?;
        let answer = ParameterExchange::decode(&bytes, byte_order);
        let errors = answer.messages & (card::ERRORS | card::CHECKSUM);
        // With a wrong check sum parameters can still be written.
        let harmless = if asked.order == order::WRITE { card::CHECKSUM } else { 0 };
        if errors & !harmless != 0 {
            return Err(Fault::CardMessages { messages: errors }.at(self.at(action)));
        }
        Ok(answer)
    }

    fn parameter_action(parameter: Parameter, written: bool) -> (u16, Action) {
        // What has no number is refused by the module as every number without parameter is.
        let number = parameter.number().unwrap_or(u16::MAX);
        (number, Action::Parameter { number, name: parameter.name(), written })
    }

    /// Reads a parameter, in motion too: its 32 bits. Asked again once if no proper answer comes: it changes nothing.
    ///
    /// # Errors
    /// If the module refuses or does not answer.
    pub async fn parameter(
        &mut self,
        parameter: Parameter,
        clock: &dyn Clock,
    ) -> Result<u32, DriveError> {
        let (number, action) = Self::parameter_action(parameter, false);
        let asked = ParameterExchange { order: order::READ, number, ..Default::default() };
        match self.read_once(action, asked, clock).await {
            Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) => {
                self.read_once(action, asked, clock).await
            }
            Err(error) if matches!(error.fault(), Some(Fault::CardMessages { .. })) => {
                self.read_once(action, asked, clock).await
            }
            done => done,
        }
    }

    async fn read_once(
        &mut self,
        action: Action,
        asked: ParameterExchange,
        clock: &dyn Clock,
    ) -> Result<u32, DriveError> {
        let answer = self.parameter_exchange(action, asked, clock).await?;
        self.check_answer(action, &asked, &answer)?;
        Ok(answer.value)
    }

    /// Writes a parameter; both axes must be at rest. Those of which [`Parameter::needs_reset`] is true act after
    /// [`Self::reset`].
    ///
    /// # Errors
    /// If the module refuses, stores something else, or does not answer.
    pub async fn set_parameter(
        &mut self,
        parameter: Parameter,
        value: u32,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (number, action) = Self::parameter_action(parameter, true);
        let asked = ParameterExchange { order: order::WRITE, number, value, messages: 0 };
        let answer = self.parameter_exchange(action, asked, clock).await?;
        self.check_answer(action, &asked, &answer)?;
        if answer.value == value {
            return Ok(());
        }
        Err(DriveError::Protocol { at: self.at(action), fault: ProtocolFault::Garbled })
    }

    fn check_answer(
        &self,
        action: Action,
        asked: &ParameterExchange,
        answer: &ParameterExchange,
    ) -> Result<(), DriveError> {
        if (answer.order, answer.number) == (asked.order, asked.number) {
            return Ok(());
        }
        Err(DriveError::Protocol { at: self.at(action), fault: ProtocolFault::Garbled })
    }

    /// Reads the parameters that the motion of an axis depends on.
    ///
    /// # Errors
    /// As [`Self::parameter`], or if the drive mode does not exist.
    pub async fn axis_settings(
        &mut self,
        axis: ModuleAxis,
        clock: &dyn Clock,
    ) -> Result<AxisSettings, DriveError> {
        let mut settings = AxisSettings::default();
        let long = async |module: &mut Self, parameter| {
            module.parameter(Parameter::Axis(parameter, axis), clock).await
        };
        let word = |value: u32| {
            let [.., high, low] = value.to_be_bytes();
            u16::from_be_bytes([high, low])
        };
        settings.coefficient = word(long(self, AxisParameter::Coefficient).await?);
        let mode = word(long(self, AxisParameter::Mode).await?);
        settings.mode = DriveMode::from_code(mode).ok_or_else(|| {
            let (_, action) =
                Self::parameter_action(Parameter::Axis(AxisParameter::Mode, axis), false);
            DriveError::Protocol { at: self.at(action), fault: ProtocolFault::Garbled }
        })?;
        settings.origin_stop = long(self, AxisParameter::OriginStop).await?;
        settings.fast_speed = word(long(self, AxisParameter::FastSpeed).await?);
        settings.start_stop_speed = word(long(self, AxisParameter::StartStopSpeed).await?);
        settings.approach = long(self, AxisParameter::Approach).await?;
        settings.soft_plus = long(self, AxisParameter::SoftPlus).await?.cast_signed();
        settings.soft_minus = long(self, AxisParameter::SoftMinus).await?.cast_signed();
        settings.acceleration = word(long(self, AxisParameter::Acceleration).await?);
        settings.hysteresis = long(self, AxisParameter::Hysteresis).await?;
        let mut references = [0; REFERENCES];
        for (place, reference) in (1..).zip(&mut references) {
            *reference = long(self, AxisParameter::Reference(place)).await?.cast_signed();
        }
        settings.references = references;
        Ok(settings)
    }

    /// Resets the module and waits until its software has stopped and runs again. Positions and homing are lost, the
    /// watchdog relay drops, phases are off.
    ///
    /// # Errors
    /// If it is not seen to stop within [`super::Bim2AxOptions::reset_start`], or to run before the deadline after that.
    pub async fn reset(&mut self) -> Result<(), DriveError> {
        let action = Action::Command { number: order::RESET, name: "RESET" };
        self.check_running(action)?;
        let asked = ParameterExchange { order: order::RESET, ..Default::default() };
        let bytes = asked.encode(self.options.byte_order);
        let written = self.window.write_zone(WriteZone::Parameter, &bytes, ReadZone::Parameter);
        self.bus(action, written)?;
        // It runs until it has read the order: only one that has been seen to stop runs again.
        let deadline = self.options.reset_start;
        let stopped = timeout(deadline, self.until_running(action, false)).await;
        stopped.unwrap_or_else(|_| Err(DriveError::Timeout { at: self.at(action), deadline }))?;
        let deadline = self.options.reset_deadline;
        let runs = timeout(deadline, self.until_running(action, true)).await;
        runs.unwrap_or_else(|_| Err(Fault::NotRunning.at(self.at(action))))
    }

    /// Looks until the module's software runs, or until it does not.
    async fn until_running(&mut self, action: Action, wanted: bool) -> Result<(), DriveError> {
        loop {
            let running = self.window.running();
            if self.bus(action, running)? == wanted {
                return Ok(());
            }
            sleep(self.options.pause).await;
        }
    }
}
