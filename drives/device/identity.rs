//! Identity of a device.

use std::fmt;

/// Identity of a device, as it reports it itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name of the family.
    pub family: &'static str,
    /// The units: one board or module, or every drive on a bus in the order of the axes.
    pub units: Vec<UnitIdentity>,
}

/// Identity of one unit of a device. Parts that the family does not report are absent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitIdentity {
    /// Address on the bus; 0 where there is none.
    pub address: u8,
    /// Version of the firmware, as its maker writes it.
    pub firmware: Option<String>,
    /// Serial number.
    pub serial: Option<String>,
    /// Everything else, name and value.
    pub details: Vec<(&'static str, String)>,
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.family)?;
        for (place, unit) in self.units.iter().enumerate() {
            f.write_str(if place == 0 { ", " } else { "; " })?;
            unit.fmt(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for UnitIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let address = (self.address != 0).then(|| format!("address {}", self.address));
        let firmware = self.firmware.as_ref().map(|version| format!("firmware {version}"));
        let serial = self.serial.as_ref().map(|number| format!("serial number {number}"));
        let details = self.details.iter().map(|(name, value)| format!("{name} {value}"));
        let parts: Vec<_> =
            address.into_iter().chain(firmware).chain(serial).chain(details).collect();
        f.write_str(&parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_known_is_said() {
        let first = UnitIdentity {
            address: 3,
            firmware: Some("1.2.0".to_owned()),
            serial: None,
            details: vec![("PID", "5342h".to_owned())],
        };
        let second =
            UnitIdentity { address: 4, serial: Some("77".to_owned()), ..Default::default() };
        let identity = Identity { family: "SmartDRIVE", units: vec![first, second] };
        let text = "SmartDRIVE, address 3, firmware 1.2.0, PID 5342h; address 4, serial number 77";
        assert_eq!(identity.to_string(), text);
    }
}
