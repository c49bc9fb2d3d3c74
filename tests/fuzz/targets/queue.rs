//! Fuzz target: any bytes as a queue file, unchanged and with corrected checksums.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use twin_path::PathElement;
use twin_path::queue::{Generator, MAX_BLOCK_BYTES, QueueReader, QueueWriter};

fuzz_target!(|file: &[u8]| {
    read(file);
    let repaired = repaired(file);
    let path = read(&repaired);
    let written = written(&path);
    let again = read(&written);
    // Bit for bit, whatever NaN would equal.
    assert_eq!(written, self::written(&again));
    assert_eq!(path.len(), again.len());
    path::sampled(path, true, |_| None);
});

/// The elements before an error, after which there is nothing.
fn read(file: &[u8]) -> Vec<PathElement> {
    let Ok(mut reader) = QueueReader::new(file) else { return Vec::new() };
    let path: Vec<_> = reader.by_ref().map_while(Result::ok).collect();
    assert!(reader.next().is_none(), "an element after an error");
    // The shortest element has a few dozen bytes.
    assert!(path.len() <= file.len() / 16, "{} elements of {} bytes", path.len(), file.len());
    path
}

fn written(path: &[PathElement]) -> Vec<u8> {
    let mut writer =
        QueueWriter::new(Vec::new(), Generator::Decoder).expect("memory takes everything");
    for element in path {
        writer.write(element).expect("memory takes everything");
    }
    writer.finish().expect("memory takes everything")
}

/// The file with a good header and the checksums that its blocks should have.
fn repaired(file: &[u8]) -> Vec<u8> {
    let mut repaired = QueueWriter::new(Vec::new(), Generator::Decoder)
        .and_then(QueueWriter::finish)
        .expect("memory takes everything");
    repaired.truncate(16);
    let mut rest = file.get(16..).unwrap_or_default();
    let mut number = 0_u64;
    while let Some((head, tail)) = rest.split_first_chunk::<5>() {
        let [tag, length @ ..] = *head;
        let length = usize::try_from(u32::from_le_bytes(length)).unwrap_or(MAX_BLOCK_BYTES);
        let payload = tail.get(..length.min(tail.len())).unwrap_or_default();
        let mut sum = crc32fast::Hasher::new();
        for part in [&number.to_le_bytes()[..], head, payload] {
            sum.update(part);
        }
        repaired.extend_from_slice(head);
        repaired.extend_from_slice(payload);
        repaired.extend_from_slice(&sum.finalize().to_le_bytes());
        if tag != b'B' {
            break;
        }
        rest = tail.get(payload.len() + 4..).unwrap_or_default();
        number += 1;
    }
    repaired
}
