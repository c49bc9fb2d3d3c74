//! Memories, pages and byte orders.

use std::{fs, io::ErrorKind, path::PathBuf};

use super::*;
use crate::{
    SharedModule,
    emulator::{Eeprom, Module, ModuleOptions, Surroundings},
    protocol::{
        vectors::{Log, Recorded},
        zone::{Orders, ParameterExchange, Plugs, Positions, ReadZone, Target, WriteZone},
    },
};

fn module() -> SharedModule {
    let options = ModuleOptions { boot_ns: 0, ..ModuleOptions::default() };
    SharedModule::new(Module::new(&options, &Eeprom::new(2000), &Surroundings::default()), || 0)
}

/// A file in a folder that lives as long as it.
fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bus");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn a_mapped_file_is_read_and_written_byte_by_byte_at_its_offset() {
    // The module's base is neither at the begin of the file nor at that of a page.
    let mut image = vec![0xAA; 0x3000];
    image[0x1200 + 0xFF] = BIM2AX_BOCM;
    let (_folder, path) = file(&image);
    let mut memory = MappedMemory::open(&path, 0x1200).unwrap();
    let mut identifier = [0];
    memory.read(IDENTIFIER, &mut identifier).unwrap();
    assert_eq!(identifier, [BIM2AX_BOCM]);
    memory.write(0x70, &[1, 2, 3, 4]).unwrap();
    memory.write(PAGE_REGISTER, &[6]).unwrap();
    let mut back = [0; 6];
    memory.read(0x6F, &mut back).unwrap();
    assert_eq!(back, [0xAA, 1, 2, 3, 4, 0xAA]);
    // Another process sees it.
    image[0x1270..0x1274].copy_from_slice(&[1, 2, 3, 4]);
    image[0x12FD] = 6;
    assert_eq!(fs::read(&path).unwrap(), image);
}

#[test]
fn a_module_that_does_not_fit_into_its_file_is_not_mapped() {
    let (folder, path) = file(&[0; 0x1FF]);
    assert!(MappedMemory::open(&path, 0xFF).is_ok());
    for start in [0x100, 0x5000, u64::MAX] {
        let error = MappedMemory::open(&path, start).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::UnexpectedEof, "{start:X}");
    }
    let error = MappedMemory::open(&folder.path().join("none"), 0).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NotFound);
}

#[test]
fn no_memory_goes_beyond_256_bytes() {
    let mut memory = module();
    assert!(memory.read(0xFE, &mut [0; 2]).is_ok());
    assert!(memory.read(0xFE, &mut [0; 3]).is_err());
    assert!(memory.write(0x00, &[]).is_err());
    assert!(memory.write(0x01, &[0; 256]).is_err());
}

#[test]
fn eight_pages_lie_behind_the_window_and_the_page_reads_back_as_status() {
    let mut memory = module();
    for page in 0..8 {
        memory.write(PAGE_REGISTER, &[page]).unwrap();
        memory.write(0x10, &[0xA0 | page]).unwrap();
    }
    for page in 0..8 {
        // Only three bits count.
        memory.write(PAGE_REGISTER, &[0xF8 | page]).unwrap();
        let mut byte = [0];
        memory.read(0x10, &mut byte).unwrap();
        assert_eq!(byte, [0xA0 | page]);
        memory.read(PAGE_REGISTER, &mut byte).unwrap();
        assert_eq!(byte, [0]);
    }
}

#[test]
fn a_memory_file_has_all_pages_and_counts_interrupts() {
    let mut image = [0; twin_drives::port::FILE_LENGTH];
    image[file_offset::STATUS] = 1;
    image[file_offset::IDENTIFIER] = BIM2AX_BOCM;
    let (_folder, path) = file(&image);
    let mut memory = MemoryFile::open(&path).unwrap();
    let mut bytes = [0, 0];
    memory.read(PAGE_REGISTER, &mut bytes[..1]).unwrap();
    memory.read(IDENTIFIER, &mut bytes[1..]).unwrap();
    assert_eq!(bytes, [1, BIM2AX_BOCM]);
    memory.write(PAGE_REGISTER, &[6]).unwrap();
    memory.write(0x7F, &[1]).unwrap();
    memory.write(PAGE_REGISTER, &[7]).unwrap();
    memory.write(0x7E, &[2, 1]).unwrap();
    memory.write(0x7F, &[1]).unwrap();
    image[0x37F] = 1;
    (image[0x3FE], image[0x3FF]) = (2, 1);
    image[file_offset::PAGE] = 7;
    // Two interrupts: on page 6 there is none.
    image[file_offset::INTERRUPTS] = 2;
    assert_eq!(fs::read(&path).unwrap(), image);
}

#[test]
fn the_byte_order_shows_in_the_card_messages() {
    use ByteOrder::{Big, Little};
    for low in 1..=0x7F {
        assert_eq!(ByteOrder::of_card_messages([0, 0, 0, low]), Some(Big));
        assert_eq!(ByteOrder::of_card_messages([low, 0, 0, 0]), Some(Little));
    }
    for silent in [[0; 4], [2, 0, 0, 2], [0, 6, 0, 0], [0xFF; 4]] {
        assert_eq!(ByteOrder::of_card_messages(silent), None);
    }
}

#[test]
fn zones_in_both_byte_orders_at_the_offsets_of_the_manual() {
    // 9.1.1, 9.1.2: fields in the order of the tables; each number's bytes as the order says.
    let orders = Orders { uc: [0x0102, 0x0304], bloc: [0x0506_0708, 0x090A_0B0C] };
    let big = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
    let little = [2, 1, 4, 3, 8, 7, 6, 5, 12, 11, 10, 9];
    let target = Target { position: -4_194_303, speed: 0x1234 };
    let (value, messages) = (0x0506_0708, 0x090A_0B0C);
    let parameter = ParameterExchange { order: 0x0102, number: 0x0304, value, messages };
    for (order, bytes) in [(ByteOrder::Big, big), (ByteOrder::Little, little)] {
        assert_eq!((orders.encode(order), Orders::decode(&bytes, order)), (bytes, orders));
        let encoded = parameter.encode(order);
        assert_eq!((encoded, ParameterExchange::decode(&bytes, order)), (bytes, parameter));
        assert_eq!(Target::decode(&target.encode(order), order), target);
    }
    let bytes = [0x01, 0x00, 0xC0, 0xFF, 0x34, 0x12, 0, 0, 0, 0, 0, 0];
    assert_eq!(target.encode(ByteOrder::Little), bytes);
    let positions = Positions { positions: [-1, 0x0102_0304], messages: [0x2010, 0x4080] };
    let bytes = [0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3, 4, 0x20, 0x10, 0x40, 0x80];
    assert_eq!(positions.encode(ByteOrder::Big), bytes);
    assert_eq!(Positions::decode(&bytes, ByteOrder::Big), positions);
    // Plug 2 at $42, four bytes after plug 1 at $3E.
    let plugs = Plugs { values: [None, Some(7)] };
    let bytes = [0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 7, 0, 0, 0, 0];
    assert_eq!(plugs.encode(ByteOrder::Big), bytes);
    assert_eq!(Plugs::decode(&bytes, ByteOrder::Big), plugs);

    let read: Vec<u8> = ReadZone::ALL.iter().map(|zone| zone.offset()).collect();
    assert_eq!(read, [0x02, 0x0E, 0x1A, 0x26, 0x32, 0x3E]);
    let written: Vec<u8> = WriteZone::ALL.iter().map(|zone| zone.offset()).collect();
    assert_eq!(written, [0x02, 0x0E, 0x1A, 0x26]);
}

#[test]
fn entries_left_over_are_cleared_before_a_single_zone_is_written() {
    let log = Log::default();
    let mut window = Window::new(Recorded(module(), log.clone()));
    let bytes = [0; 12];
    window.write_zones(&[(WriteZone::Position2, bytes)]).unwrap();
    assert!(log.take().contains(&"70..73←72 00 00 00".to_owned()));
    window.write_zone(WriteZone::Orders, &bytes, ReadZone::Acknowledgements).unwrap();
    assert_eq!(
        log.take(),
        [
            "FD←07",
            "70..73←00 00 00 00",
            "00←01",
            "02..0D←00 00 00 00 00 00 00 00 00 00 00 00",
            "01←01",
            "7F←01"
        ]
    );
    window.write_zone(WriteZone::Orders, &bytes, ReadZone::Acknowledgements).unwrap();
    assert!(!log.take().iter().any(|access| access.starts_with("70")));
}

#[test]
fn entries_of_a_program_that_died_are_cleared_before_the_first_order() {
    let mut memory = module();
    memory.write(PAGE_REGISTER, &[HOST_PAGE]).unwrap();
    memory.write(ENTRIES, &[0x72, 0x70, 0, 0]).unwrap();
    let log = Log::default();
    let mut window = Window::new(Recorded(memory, log.clone()));
    window.write_zone(WriteZone::Orders, &[0; 12], ReadZone::Acknowledgements).unwrap();
    assert_eq!(log.take()[..3], ["FD←07", "70..73←00 00 00 00", "00←01"]);
}
