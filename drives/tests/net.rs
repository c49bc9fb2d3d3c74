//! The net: a hash of every byte that one run of each family exchanges with its emulator, in virtual time.
//!
//! Moved code must send the same bytes. The hashes are not correctness: the vectors of each family are. A change that
//! is meant to change an exchange puts the hash that the failing test prints here, in a commit of its own.

use std::{
    f64::consts::TAU,
    io,
    sync::{Arc, Mutex},
};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, DuplexStream, duplex, split},
    runtime::{Builder, Runtime},
    sync::mpsc,
    time::Instant,
};

use super::{
    bench::{eeprom, smartdrive_axis},
    common::Plan,
};
use twin_bim2ax::{
    Bim2AxDrive, Bim2AxDriveOptions, Memory, SharedModule,
    emulator::{Module, ModuleOptions, Surroundings},
    protocol::bits::coefficient,
};
use twin_drives::{Drive, IncrementMotion, SetpointStream};
use twin_interpcnc as interpcnc;
use twin_interpcnc::{
    AxisOptions, BoardAxis, InterpCnc, InterpCncDrive, InterpCncOptions,
    emulator::{Board, BoardOptions},
};
use twin_smartdrive as smartdrive;
use twin_smartdrive::{
    SmartDrive, SmartDriveBus, SmartDriveOptions,
    emulator::{Device, DeviceOptions},
};

/// The bytes of a wire in the order in which they pass; 0 and 1 before them where the direction changes.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<(Vec<u8>, Option<u8>)>>);

impl Log {
    fn add(&self, direction: u8, bytes: &[u8]) {
        let mut log = self.0.lock().unwrap();
        if log.1.replace(direction) != Some(direction) {
            log.0.push(direction);
        }
        log.0.extend_from_slice(bytes);
    }

    /// Number of bytes and their hash.
    fn seen(&self) -> (usize, u32) {
        let log = self.0.lock().unwrap();
        (log.0.len(), crc32fast::hash(&log.0))
    }
}

/// Length of the plan and of the run, s.
const PERIOD_S: f64 = 1.5;
const END_NS: i64 = 2_000_000_000;

/// A plan of two axes, to and fro, that begins 200 ms after the clock.
fn to_and_fro(clock: impl Fn() -> i64 + Sync, stroke: f64) -> impl SetpointStream {
    let of = move |time: f64| {
        let angle = TAU * time.clamp(0.0, PERIOD_S) / PERIOD_S;
        let axis = |stroke: f64| {
            (0.5 * stroke * (1.0 - angle.cos()), 0.5 * stroke * TAU / PERIOD_S * angle.sin())
        };
        IncrementMotion::of([stroke, -0.5 * stroke].into_iter().map(axis))
    };
    Plan { clock, start_ns: 200_000_000, of }
}

/// Time that passes only while a runtime sleeps, and its clock.
fn virtual_time() -> (Runtime, impl Fn() -> i64 + Send + Sync + Clone) {
    let runtime = Builder::new_current_thread().enable_all().start_paused(true).build().unwrap();
    let handle = runtime.handle().clone();
    let zero = runtime.block_on(async { Instant::now() });
    let clock = move || {
        let _inside = handle.enter();
        i64::try_from(zero.elapsed().as_nanos()).unwrap()
    };
    (runtime, clock)
}

/// A wire with a log: the ends of the driver and of the device.
fn tapped(runtime: &Runtime, log: &Log) -> (DuplexStream, DuplexStream) {
    let (driver, near) = duplex(4096);
    let (far, device) = duplex(4096);
    let (from_driver, to_driver) = split(near);
    let (from_device, to_device) = split(far);
    runtime.spawn(pass(from_driver, to_device, 0, log.clone()));
    runtime.spawn(pass(from_device, to_driver, 1, log.clone()));
    (driver, device)
}

async fn pass(
    mut from: impl AsyncRead + Unpin,
    mut to: impl AsyncWrite + Unpin,
    direction: u8,
    log: Log,
) -> io::Result<()> {
    let mut buffer = [0; 256];
    loop {
        let count = from.read(&mut buffer).await?;
        if count == 0 {
            return Ok(());
        }
        log.add(direction, &buffer[..count]);
        to.write_all(&buffer[..count]).await?;
    }
}

/// One run: identity, zero, a move, following to the end of the plan, a stop.
fn drive(drive: &mut dyn Drive, plan: &dyn SetpointStream, speed: f64) {
    drive.probe(plan).unwrap();
    drive.identity().unwrap();
    drive.enable().unwrap();
    drive.set_position(&[40, -30, 0, 0, 0]).unwrap();
    drive.move_to(&[0; 5], &[speed; 5]).unwrap();
    while drive.sample(plan).unwrap().moving {}
    let begin = plan.now_ns();
    while plan.now_ns() < begin.max(0) + END_NS {
        drive.follow(plan).unwrap();
    }
    drive.soft_stop().unwrap();
    drive.hard_stop().unwrap();
}

#[test]
fn the_bytes_of_an_interpcnc_stay() {
    let (runtime, clock) = virtual_time();
    let log = Log::default();
    let (near, far) = tapped(&runtime, &log);
    let (_control, messages) = mpsc::channel(1);
    let device_clock = clock.clone();
    runtime.spawn(async move {
        let board = Board::new(&BoardOptions::default());
        let wire = interpcnc::emulator::Wire::default();
        interpcnc::emulator::serve(far, board, &wire, &device_clock, messages).await.map(|_| ())
    });
    let options =
        InterpCncOptions::new([BoardAxis::X, BoardAxis::Y].map(AxisOptions::new).to_vec());
    let board = InterpCnc::attach("wire".into(), near, &options);
    let mut board = InterpCncDrive::on(runtime, board, &options);
    drive(&mut board, &to_and_fro(clock, 4000.0), 2000.0);
    assert_eq!(log.seen(), (9355, 0x24AD_7102));
}

#[test]
fn the_bytes_of_smartdrives_stay() {
    let (runtime, clock) = virtual_time();
    let log = Log::default();
    let (near, far) = tapped(&runtime, &log);
    let (_control, messages) = mpsc::channel(1);
    let device_clock = clock.clone();
    runtime.spawn(async move {
        let device = |address| Device::new(&DeviceOptions { address, ..DeviceOptions::default() });
        let wire = smartdrive::emulator::Wire::default();
        let devices = vec![device(3), device(7)];
        smartdrive::emulator::serve(far, devices, &wire, &device_clock, messages).await.map(|_| ())
    });
    let options = SmartDriveOptions::new(vec![smartdrive_axis(3), smartdrive_axis(7)]);
    let bus = SmartDrive::attach("wire".into(), near, &options);
    let mut bus = SmartDriveBus::on(runtime, bus, &options);
    drive(&mut bus, &to_and_fro(clock, 4000.0), 2000.0);
    assert_eq!(log.seen(), (11_958, 0x3D99_A46D));
}

/// A memory with a log: address and bytes of every access.
struct Tapped {
    memory: SharedModule,
    log: Log,
}

impl Memory for Tapped {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        self.memory.read(offset, bytes)?;
        self.log.add(1, &[offset]);
        self.log.add(1, bytes);
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        self.log.add(0, &[offset]);
        self.log.add(0, bytes);
        self.memory.write(offset, bytes)
    }
}

#[test]
fn the_bytes_of_a_bim2ax_stay() {
    let (runtime, clock) = virtual_time();
    let options = ModuleOptions { boot_ns: 0, ..ModuleOptions::default() };
    let module =
        Module::new(&options, &eeprom(coefficient::IGNORE_SWITCHES), &Surroundings::default());
    let log = Log::default();
    let memory = Tapped { memory: SharedModule::new(module, clock.clone()), log: log.clone() };
    let mut module =
        Bim2AxDrive::on(runtime, "module", memory, &Bim2AxDriveOptions::new()).unwrap();
    drive(&mut module, &to_and_fro(clock, 600.0), 1000.0);
    assert_eq!(log.seen(), (31_066, 0x0356_36F4));
}
