//! BIM2AX: zones of the dual-port memory and parameters, and a host that writes any bytes to the emulated module.

use twin_bim2ax::emulator::{Eeprom, Module, ModuleOptions, Surroundings};
use twin_bim2ax::protocol::memory::{HOST_PAGE, IDENTIFIER, INTERRUPT, PAGE_REGISTER};
use twin_bim2ax::protocol::parameter::Parameter;
use twin_bim2ax::protocol::zone::{Orders, ParameterExchange, Plugs, Positions, Target, ZoneBytes};
use twin_bim2ax::{ByteOrder, DriveMode, ModuleAxis};

/// Time until the module's software runs, ns.
const BOOT_NS: i64 = 600_000_000;

pub fn check(bytes: &[u8]) {
    if let Some(zone) = bytes.first_chunk() {
        zones(zone);
    }
    let number = bytes.first_chunk().map_or(0, |number| u16::from_be_bytes(*number));
    if let Some(parameter) = Parameter::from_number(number) {
        assert_eq!(parameter.number(), Some(number), "{parameter:?}");
        assert_eq!(Parameter::named(&parameter.word()), Some(parameter));
    }
    assert!(DriveMode::from_code(number).is_none_or(|mode| mode.code() == number));
    let options = ModuleOptions::default();
    let mut module = Module::new(&options, &Eeprom::new(2000), &Surroundings::default());
    module.advance(BOOT_NS);
    module.bus_write(PAGE_REGISTER, HOST_PAGE);
    for (pause_ns, request) in super::requests(bytes) {
        // An offset, and what is written from there on; then the interrupt.
        let [offset, written @ ..] = request else { continue };
        for (offset, byte) in (*offset..=u8::MAX).zip(written) {
            module.bus_write(offset, *byte);
        }
        module.bus_write(INTERRUPT, 1);
        module.advance(module.now_ns() + options.interrupt_ns + pause_ns);
        assert_ne!(module.bus_read(IDENTIFIER), 0xFF, "the module is still there");
        for axis in ModuleAxis::ALL {
            assert!(module.position(axis).is_finite() && module.velocity(axis).is_finite());
        }
    }
    let image = module.eeprom().to_bytes();
    assert_eq!(Eeprom::of_image(&image).as_ref(), Some(module.eeprom()));
}

fn zones(bytes: &ZoneBytes) {
    for order in [ByteOrder::Big, ByteOrder::Little] {
        assert_eq!(Orders::decode(bytes, order).encode(order), *bytes);
        assert_eq!(Positions::decode(bytes, order).encode(order), *bytes);
        assert_eq!(ParameterExchange::decode(bytes, order).encode(order), *bytes);
        // Their last bytes mean nothing.
        assert_eq!(Target::decode(bytes, order).encode(order)[..6], bytes[..6]);
        assert_eq!(Plugs::decode(bytes, order).encode(order)[..8], bytes[..8]);
    }
}
