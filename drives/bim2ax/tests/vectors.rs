//! The vectors of the digest in both directions.

use std::collections::BTreeSet;

use super::*;
use crate::{
    Memory,
    protocol::{
        bits::message,
        vectors::{VECTORS, answer, play, vector},
        zone::{Orders, ReadZone},
    },
};

/// Parameters with which the manual's examples come out as printed: 2000 as fast speed of axis 1, axis 2 slow enough
/// that its position still shows 0 when homing is looked at, its cam narrow enough to be left by the way to the
/// origin.
fn example_eeprom() -> Eeprom {
    let mut eeprom = eeprom();
    set(&mut eeprom, ModuleAxis::One, AxisParameter::FastSpeed, 0x07D0);
    set(&mut eeprom, ModuleAxis::Two, AxisParameter::StartStopSpeed, 10);
    set(&mut eeprom, ModuleAxis::Two, AxisParameter::OriginStop, 20);
    set(&mut eeprom, ModuleAxis::Two, AxisParameter::Reference(5), -7);
    eeprom
}

fn example_surroundings() -> Surroundings {
    let mut surroundings = surroundings();
    let [one, two] = &mut surroundings.benches;
    one.plus = Some(Contact::above(50, true));
    (one.minus, one.cam) = (Some(Contact::below(-5_000_000, true)), None);
    two.cam = Some(Contact::between(-9, -5, true));
    two.plus = Some(Contact::above(1_000_000, true));
    surroundings.plugs = [None, Some(0x1234_5678)];
    surroundings
}

/// Vectors that the driver does not write: manual moves, a move to a switch, reference positions, relative moves, reading of
/// plugs.
const UNSENT: [usize; 11] = [8, 9, 10, 11, 12, 19, 20, 21, 22, 23, 28];

/// Vectors that a test has used.
#[derive(Default)]
struct Used(BTreeSet<usize>);

impl Used {
    /// Asserts that the accesses of vectors come one after the other in a record.
    #[track_caller]
    fn find(&mut self, log: &[String], numbers: &[usize]) {
        let mut rest = log;
        for number in numbers {
            self.0.insert(*number);
            let wanted = vector(*number);
            // The bytes of an answer that the vector leaves open may be any.
            let same = |(seen, wanted): (&String, &String)| {
                seen == wanted || wanted.ends_with('→') && seen.starts_with(wanted.as_str())
            };
            let place = rest
                .windows(wanted.len())
                .position(|part| part.iter().zip(&wanted).all(same))
                .unwrap_or_else(|| panic!("vector {number} {wanted:?} is not in {rest:#?}"));
            rest = &rest[place + wanted.len()..];
        }
    }

    /// Asserts that an answer is that of a vector.
    #[track_caller]
    fn answered(&mut self, number: usize, bytes: &[u8]) {
        assert_eq!(bytes, answer(number), "vector {number}");
        self.0.insert(number);
    }

    #[track_caller]
    fn all(&self, unsent: &[usize]) {
        let missing: Vec<_> = VECTORS
            .iter()
            .filter(|(number, ..)| !self.0.contains(number) && !unsent.contains(number))
            .collect();
        assert!(missing.is_empty(), "not exercised: {missing:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn the_driver_writes_and_understands_its_vectors() {
    let (one, two) = (ModuleAxis::One, ModuleAxis::Two);
    let singly = Bim2AxOptions { zones_at_once: false, ..Bim2AxOptions::default() };
    let surroundings = example_surroundings();
    let options = ModuleOptions::default();
    let Rig { mut driver, log, .. } =
        Rig::new(&options, &singly, &example_eeprom(), &surroundings).await;
    let clock = &clock();
    let mut used = Used::default();

    assert_eq!(driver.acknowledgements(clock).await.unwrap(), Orders::default());
    used.find(&log.take(), &[1]);

    let fast = Parameter::Axis(AxisParameter::FastSpeed, one);
    assert_eq!(driver.parameter(fast, clock).await.unwrap(), 2000);
    used.find(&log.take(), &[2, 3]);
    let holding = Parameter::Axis(AxisParameter::HoldingCurrent, one);
    driver.set_parameter(holding, 200, clock).await.unwrap();
    used.find(&log.take(), &[4]);

    driver.home(&[two], clock).await.unwrap();
    used.find(&log.take(), &[5]);
    let (homing, _) = driver.positions(clock).await.unwrap();
    assert_eq!(homing.messages[1], message::MOVING);
    used.find(&log.take(), &[6]);
    let (homed, _) = driver.rested(seconds(100), clock).await.unwrap();
    assert_eq!(homed.messages[1], message::HOMED);
    used.find(&log.take(), &[7]);

    driver.start([None, Some(Start::to(-7))], clock).await.unwrap();
    driver.rested(seconds(100), clock).await.unwrap();
    driver.zero(two, clock).await.unwrap();
    driver.recall(two, clock).await.unwrap();
    used.find(&log.take(), &[13, 14]);
    assert_eq!(driver.positions(clock).await.unwrap().0.positions[1], -7);
    driver.preset(one, 12_345, clock).await.unwrap();
    used.find(&log.take(), &[15, 16]);
    assert_eq!(driver.positions(clock).await.unwrap().0.positions[0], 12_345);

    driver.start([None, Some(Start::to(2000))], clock).await.unwrap();
    used.find(&log.take(), &[17, 18]);
    driver.rested(seconds(100), clock).await.unwrap();
    let far = Start { to: -4_194_303, speed: Some(65_535), directly: false };
    driver.start([Some(far), None], clock).await.unwrap();
    used.find(&log.take(), &[29]);
    driver.stop_hard(clock).await.unwrap();
    used.find(&log.take(), &[26]);
    driver.rested(seconds(10), clock).await.unwrap();
    driver.reset().await.unwrap();
    used.find(&log.take(), &[27]);

    let at_once = Bim2AxOptions::default();
    let mut rig = Rig::new(&options, &at_once, &example_eeprom(), &surroundings).await;
    rig.driver.start([None, Some(Start::to(2000))], clock).await.unwrap();
    let log = rig.log.take();
    used.find(&log, &[25, 24]);
    assert!(log.contains(&"70→00".to_owned()), "the receipt is looked for");
    used.all(&UNSENT);
}

/// A module in simulated time that vectors are played to.
struct Bench {
    module: Module,
    clock_ns: i64,
}

impl Bench {
    fn new(surroundings: &Surroundings) -> Self {
        let module = Module::new(&ModuleOptions::default(), &example_eeprom(), surroundings);
        let mut bench = Self { module, clock_ns: 0 };
        bench.wait_ms(1000);
        bench
    }

    fn wait_ms(&mut self, ms: i64) {
        self.clock_ns += ms * 1_000_000;
        self.module.advance(self.clock_ns);
    }

    /// Plays a vector and waits for its effect.
    fn play(&mut self, used: &mut Used, number: usize) {
        used.0.insert(number);
        play(number, self);
        self.wait_ms(1);
    }

    /// Page 6 as it is.
    fn zone(&mut self, zone: ReadZone) -> Vec<u8> {
        self.module.bus_write(0xFD, 6);
        (zone.offset()..zone.offset() + 12).map(|offset| self.module.bus_read(offset)).collect()
    }

    /// Has it refreshed and reads a zone.
    fn fresh(&mut self, zone: ReadZone) -> Vec<u8> {
        let order = [(0xFD, 7), (0, 0xF0 | zone.number()), (1, 1), (0x70, 0), (0x71, 0), (0x7F, 1)];
        write(&mut self.module, &order);
        self.wait_ms(1);
        self.zone(zone)
    }

    fn messages(&mut self) -> [u8; 4] {
        self.fresh(ReadZone::Positions)[8..].try_into().unwrap()
    }
}

impl Memory for Bench {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> std::io::Result<()> {
        for (offset, byte) in (offset..).zip(bytes) {
            *byte = self.module.bus_read(offset);
        }
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> std::io::Result<()> {
        for (offset, byte) in (offset..).zip(bytes) {
            self.module.bus_write(offset, *byte);
        }
        Ok(())
    }
}

#[test]
fn the_module_answers_every_vector() {
    let mut used = Used::default();
    let mut bench = Bench::new(&example_surroundings());
    let (positions, acks) = (ReadZone::Positions, ReadZone::Acknowledgements);
    let position =
        |bytes: &[u8], at: usize| i32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());

    bench.play(&mut used, 1);
    assert_eq!((bench.zone(acks), bench.module.bus_read(0)), (vec![0; 12], 1));

    bench.play(&mut used, 2);
    used.answered(3, &bench.zone(ReadZone::Parameter));
    bench.play(&mut used, 4);
    assert_eq!(bench.zone(ReadZone::Parameter)[..8], [0x10, 0, 0, 6, 0, 0, 0, 0xC8]);
    // 7.6: writing the holding current switches the phases of axis 1 on.
    assert_eq!(bench.messages(), [0, 0, 0, 0x80]);

    bench.play(&mut used, 5);
    assert_eq!(bench.zone(acks), [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    used.answered(6, &bench.fresh(positions));
    bench.wait_ms(10_000);
    used.answered(7, &bench.fresh(positions));
    assert_eq!(bench.fresh(acks), [0; 12]);

    bench.play(&mut used, 8);
    assert_eq!(bench.zone(acks)[..4], [0, 0, 0, 0x10]);
    assert_eq!(bench.messages(), [0, 0, 0, 0x30]);
    bench.play(&mut used, 9);
    assert_eq!(bench.zone(acks)[..4], [0; 4]);
    assert_eq!(bench.messages(), [0, 0, 0, 0x10]);

    bench.play(&mut used, 10);
    assert_eq!(bench.zone(acks)[..4], [0, 0x40, 0, 0]);
    bench.wait_ms(100);
    // 5.3.1 prints $0000; 7.1 demands the bit of the switch.
    assert_eq!(bench.messages()[..2], [0, 1]);

    bench.play(&mut used, 11);
    assert_eq!(bench.zone(acks), [0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0]);
    bench.wait_ms(10_000);
    used.answered(12, &bench.fresh(acks));

    bench.play(&mut used, 13);
    assert_eq!(bench.zone(acks)[8..], [0, 0, 0, 0x10]);
    assert_eq!(bench.fresh(positions)[4..], [0, 0, 0, 0, 0, 1, 0, 0x10]);
    bench.play(&mut used, 14);
    assert_eq!(bench.zone(acks)[8..], [0, 0, 0, 0x20]);
    assert_eq!(position(&bench.fresh(positions), 4), -7);

    bench.play(&mut used, 15);
    bench.play(&mut used, 16);
    assert_eq!(bench.zone(acks)[4..8], [0, 0, 0, 0x20]);
    assert_eq!(position(&bench.fresh(positions), 0), 12_345);

    bench.play(&mut used, 17);
    bench.play(&mut used, 18);
    assert_eq!(bench.zone(acks)[..4], [0, 0, 0, 2]);
    bench.wait_ms(10_000);
    assert_eq!(position(&bench.fresh(positions), 4), 2000);
    bench.play(&mut used, 19);
    bench.play(&mut used, 20);
    bench.wait_ms(10_000);
    assert_eq!(position(&bench.fresh(positions), 4), 2400);

    // 6.4.1: both from 1000, axis 1 not on its switch any more.
    let mut free = example_surroundings();
    free.benches[0].plus = Some(Contact::above(5_000_000, true));
    bench.module.set_surroundings(&free);
    for number in [21, 22, 23] {
        bench.play(&mut used, number);
    }
    // "$50000000" in the manual is of no defined bits: 0 while it moves.
    assert_eq!(bench.zone(acks), [0, 2, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(bench.messages(), [0, 0x30, 0, 0x30]);
    bench.wait_ms(3000);
    // 400 at 200 µsteps/s are over after 2 s, 800 at 100 after 8 s.
    assert_eq!(position(&bench.fresh(positions), 0), 12_745);
    assert_eq!(bench.messages(), [0, 0x10, 0, 0x30]);
    bench.play(&mut used, 26);
    assert_eq!(bench.zone(acks)[..4], [0, 0, 1, 0], "only axis 2 moves");
    assert_eq!(bench.messages(), [0, 0x10, 0, 0x40]);

    bench.play(&mut used, 29);
    bench.play(&mut used, 18);
    assert_eq!(bench.messages()[..2], [0, 0x10], "a target alone moves nothing");
    // Axis 2 goes to the 800 of vector 22, as an absolute position now.
    bench.wait_ms(300_000);
    assert_eq!(position(&bench.fresh(positions), 4), 800);
    // Ordre UC axis 1 = programmed, bloc = programmed speed.
    let order = [(0xFD, 7), (0, 1), (3, 2), (2, 0), (5, 0), (8, 1), (9, 0), (1, 1), (0x7F, 1)];
    write(&mut bench.module, &order);
    bench.wait_ms(1);
    bench.wait_ms(4_194_303 / 2000 * 1000 + 20_000);
    assert_eq!(position(&bench.fresh(positions), 0), -4_194_303);

    bench.play(&mut used, 28);
    assert_eq!(bench.fresh(ReadZone::Parameter)[..4], [0; 4], "not yet read");
    bench.wait_ms(700);
    assert_eq!(bench.fresh(ReadZone::Parameter)[..4], [0x40, 0, 0, 2]);
    let plugs = bench.fresh(ReadZone::Plugs);
    assert_eq!(plugs, [0xFF, 0xFF, 0xFF, 0xFF, 0x12, 0x34, 0x56, 0x78, 0, 0, 0, 0]);

    // Back to absolute 0, then the two zones with one interrupt.
    bench.play(&mut used, 13);
    bench.play(&mut used, 25);
    bench.play(&mut used, 24);
    bench.module.bus_write(0xFD, 6);
    assert_eq!(bench.module.bus_read(0x70), 0);
    assert_eq!(bench.messages()[2..], [0, 0x30]);
    bench.wait_ms(10_000);
    assert_eq!(position(&bench.fresh(positions), 4), 2000);

    bench.play(&mut used, 27);
    assert_eq!(bench.module.bus_read(0xFD) & 1, 1, "it restarts");
    bench.wait_ms(600);
    assert_eq!(bench.module.bus_read(0xFD) & 1, 0);
    assert_eq!(bench.messages(), [0, 0x80, 0, 0x80], "phases off, homing lost");
    used.all(&[]);
}
