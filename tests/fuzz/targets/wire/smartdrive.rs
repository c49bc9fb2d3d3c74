//! SmartDRIVE: commands and answers of ATB, and commands to the emulated device.

use twin_smartdrive::emulator::{Device, DeviceOptions};
use twin_smartdrive::protocol::frame::{self, ANSWER_BYTES, Answer};

pub fn check(bytes: &[u8]) {
    if let Some(first) = bytes.first_chunk::<ANSWER_BYTES>()
        && let Some(answer) = Answer::decode(first)
    {
        assert_eq!(answer.encode(), *first);
    }
    let options = DeviceOptions::default();
    let mut device = Device::new(&options);
    for (pause_ns, request) in super::requests(bytes) {
        device.advance(pause_ns);
        let whole = frame::check_sum(request) == 0;
        let answer = device.handle(request);
        assert!(whole || answer.is_none(), "{answer:?} to a frame with a wrong check sum");
        // The command alone: its length follows from the code.
        let [code, data @ ..] = request else { continue };
        let mut command = vec![device.address(), *code];
        command.extend(data);
        let length = frame::command_length(&command).expect("a code");
        command.resize(length - 1, 0);
        command.push(frame::check_sum(&command));
        let (address, decoded) = frame::decode(&command).expect("a frame with its check sum");
        if let Ok(decoded) = decoded {
            let encoded = frame::encode(address, &decoded);
            assert_eq!(frame::decode(&encoded), Some((address, Ok(decoded))));
        }
        if let Some(answer) = device.handle(&command) {
            let answer = answer.first_chunk().and_then(Answer::decode).expect("an answer");
            assert_eq!(answer.status.address(), address, "{answer:?} to {command:?}");
        }
        let (position, velocity) = device.motion();
        assert!(position.is_finite() && velocity.is_finite(), "{position} {velocity}");
        assert!(device.mechanical().is_finite());
    }
    let flash = device.flash();
    let again = Device::with_flash(&options, &flash).expect("an image of a device");
    assert_eq!(again.flash(), flash);
}
