//! Bags that were cut off, overwritten or never finished: what is whole is read, the rest is told.

use std::io::Cursor;

use imu_tests::bags::{Packing, bag, chunk, closed_bag, connection, message, packed_chunk, record};
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions};

const IMU: &str = "sensor_msgs/Imu";

/// The seconds at which samples are stamped, and what is told.
type Read = Result<(Vec<i64>, Vec<Note>), Error>;

fn drain(mut source: Box<dyn recording::Source>) -> Read {
    let (mut seconds, mut block) = (Vec::new(), Block::default());
    while source.next_block(&mut block)? {
        seconds.extend(block.gyroscope.iter().map(|s| s.stamp_ns / 1_000_000_000));
    }
    Ok((seconds, source.take_notes()))
}

fn read_pipe(bytes: &[u8]) -> Read {
    let stream = Box::new(Cursor::new(bytes.to_vec()));
    drain(recording::read_from("a.bag".as_ref(), stream, &ReadOptions::default())?)
}

fn read_file(bytes: &[u8]) -> Read {
    let file = tempfile::NamedTempFile::with_suffix(".bag").unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    drain(recording::open(file.path(), &ReadOptions::default())?)
}

fn warned(notes: &[Note]) -> bool {
    notes.iter().any(|note| matches!(note, Note::Warning(_)))
}

/// Messages of a chunk.
const EACH: usize = 4;

/// Three chunks of messages at seconds 1, 2, 3, …; each describes the connection.
fn chunks(packing: Packing) -> Vec<Vec<u8>> {
    let messages = (1..=3 * EACH as u32).map(|sec| message(0, sec, 0)).collect::<Vec<_>>();
    messages
        .chunks(EACH)
        .map(|of| packed_chunk(packing, &[&[connection(0, "/imu", IMU)], of].concat()))
        .collect()
}

/// A bag that was closed and one that was not, and where each chunk ends in it.
fn bags(packing: Packing) -> [(Vec<u8>, Vec<usize>); 2] {
    let chunks = chunks(packing);
    [closed_bag(&connection(0, "/imu", IMU), &chunks), bag(&chunks)].map(|bytes| {
        let end = |chunk: &Vec<u8>| {
            let start = bytes.windows(chunk.len()).position(|at| at == chunk);
            start.unwrap() + chunk.len()
        };
        let ends = chunks.iter().map(end).collect();
        (bytes, ends)
    })
}

#[test]
fn compressed_chunks_are_read_in_a_file_and_in_a_pipe() {
    let all: Vec<i64> = (1..=3 * EACH as i64).collect();
    for packing in Packing::ALL {
        let [(closed, _), (open, _)] = bags(packing);
        for read in [read_file, read_pipe] {
            assert_eq!(read(&closed).unwrap(), (all.clone(), vec![]), "{packing:?}");
            let (seconds, notes) = read(&open).unwrap();
            assert_eq!(seconds, all);
            let [Note::Warning(told)] = &notes[..] else { panic!("{notes:?}") };
            assert!(told.contains("not closed"), "{told}");
        }
    }
}

#[test]
fn a_cut_anywhere_costs_what_is_behind_it_and_is_told() {
    for packing in Packing::ALL {
        for (bytes, ends) in bags(packing) {
            let mut most = 0;
            for cut in 0..bytes.len() {
                let cut_off = &bytes[..cut];
                let whole_chunks = ends.iter().filter(|end| **end <= cut).count();
                let here = format!("{packing:?} cut at {cut} of {}", bytes.len());
                let mut results = vec![read_pipe(cut_off)];
                if cut % 16 == 0 {
                    results.push(read_file(cut_off));
                }
                for result in results {
                    let Ok((seconds, notes)) = result else {
                        assert_eq!(most, 0, "{here}");
                        continue;
                    };
                    assert!(warned(&notes), "{here}");
                    // All of the whole chunks, nothing invented, and never less of a longer file.
                    let count = seconds.len();
                    assert!(seconds.iter().copied().eq(1..=count as i64), "{here}: {seconds:?}");
                    assert!(count >= most.max(whole_chunks * EACH), "{here}: {seconds:?}");
                    most = count;
                    // A message is 364 bytes long; LZ4 makes them shorter, not longer.
                    let inside = ends.iter().map(|end| end.saturating_sub(cut + 20)).min();
                    if packing != Packing::Bz2 && inside == Some(0) {
                        let next = ends.iter().filter(|end| **end <= cut + 20).count();
                        assert!(count + 1 >= next * EACH, "{here}: {seconds:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn damage_anywhere_costs_what_it_hits() {
    for packing in Packing::ALL {
        for (bytes, _) in bags(packing) {
            let whole = read_pipe(&bytes).unwrap();
            let step = if packing == Packing::Bz2 { 5 } else { 1 }; // bz2 costs the most
            for at in (13..bytes.len()).step_by(step) {
                let mut damaged = bytes.clone();
                for byte in &mut damaged[at..(at + 6).min(bytes.len())] {
                    *byte ^= 0xa5;
                }
                let here = format!("{packing:?} damaged at {at}");
                let (seconds, notes) = read_pipe(&damaged).unwrap_or_default();
                let kept = (1..=3 * EACH as i64).filter(|s| seconds.contains(s)).count();
                // Of what is not compressed, two messages at most, or those of a connection that
                // is not described; else two chunks, where the length of one is hit.
                let least = if packing == Packing::None { 2 * EACH } else { EACH };
                assert!(kept >= least, "{here}: {seconds:?} {notes:?}");
                // Without a checksum, values that were hit cannot be told from others.
                let wrong = packing != Packing::None && kept < seconds.len();
                if wrong || seconds.len() < whole.0.len() {
                    assert!(warned(&notes), "{here}: {seconds:?}");
                }
            }
        }
    }
}

#[test]
fn reading_goes_on_behind_a_hole() {
    for packing in Packing::ALL {
        let [(bytes, ends), _] = bags(packing);
        // From the middle of the first chunk to the middle of the second.
        let (from, to) = (ends[0] - 60, ends[1] - 60);
        let mut holed = bytes.clone();
        holed[from..to].fill(0);
        let lacking = [&bytes[..from], &bytes[to..]].concat();
        for bytes in [holed, lacking] {
            for read in [read_file, read_pipe] {
                let (seconds, notes) = read(&bytes).unwrap();
                assert!(seconds.ends_with(&[9, 10, 11, 12]), "{packing:?}: {seconds:?} {notes:?}");
                // Of bz2 nothing can be unpacked without a block's end; LZ4 makes three of these
                // messages 60 bytes long.
                let before: &[i64] = match packing {
                    Packing::None => &[1, 2, 3],
                    Packing::Bz2 => &[],
                    Packing::Lz4 => &[1],
                };
                assert!(seconds.starts_with(before), "{packing:?}: {seconds:?}");
                assert!(warned(&notes));
            }
        }
    }
}

#[test]
fn a_chunk_that_a_recorder_was_writing_when_it_died_is_read() {
    for packing in [Packing::Bz2, Packing::Lz4] {
        let data = [connection(0, "/imu", IMU), message(0, 5, 0), message(0, 6, 0)].concat();
        let fields: [(&str, &[u8]); 3] =
            [("compression", packing.name().as_bytes()), ("op", &[5]), ("size", &[0; 4])];
        let dying = [bag(&[record(&fields, &[])]), packing.pack(&data)].concat();
        let (seconds, notes) = read_pipe(&dying).unwrap();
        assert_eq!(seconds, [5, 6]);
        assert!(warned(&notes), "{notes:?}");
        let (seconds, _) = read_pipe(&[dying, chunk(&[message(0, 7, 0)])].concat()).unwrap();
        assert_eq!(seconds, [5, 6, 7]);
    }
}

#[test]
fn what_a_chunk_says_of_its_size_decides_nothing() {
    for packing in Packing::ALL {
        let data = [connection(0, "/imu", IMU), message(0, 5, 0)].concat();
        let packed = packing.pack(&data);
        let name = packing.name().as_bytes();
        for (size, len) in [(u32::MAX, packed.len() as u32), (1, u32::MAX), (u32::MAX, u32::MAX)] {
            let size = size.to_le_bytes();
            let mut lying = record(&[("compression", name), ("op", &[5]), ("size", &size)], &[]);
            let at = lying.len() - 4;
            lying[at..].copy_from_slice(&len.to_le_bytes());
            lying.extend(&packed);
            for read in [read_file, read_pipe] {
                let (seconds, notes) =
                    read(&bag(&[lying.clone(), chunks(packing)[0].clone()])).unwrap();
                assert_eq!(seconds, [5, 1, 2, 3, 4], "{packing:?} {size:?} {len}: {notes:?}");
                assert!(warned(&notes));
            }
        }
    }
}

#[test]
fn garbage_is_stepped_over_in_bounded_memory() {
    // Two megabytes that begin as records do, between two chunks.
    let garbage = b"\x26\0\0\0\x09\0\0\0conn=".repeat(150_000);
    let [first, _, last] = &chunks(Packing::None)[..] else { panic!() };
    let bytes = bag(&[first.clone(), garbage, last.clone()]);
    let (seconds, notes) = read_pipe(&bytes).unwrap();
    assert_eq!(seconds, [1, 2, 3, 4, 9, 10, 11, 12]);
    assert!(notes.len() <= 22, "{}", notes.len());
}

#[test]
fn encrypted_and_unknown_chunks_are_told() {
    let fields: [(&str, &[u8]); 3] =
        [("encryptor", b"rosbag/AesCbcEncryptor"), ("index_pos", &[0; 8]), ("op", &[3])];
    let encrypted = [b"#ROSBAG V2.0\n".to_vec(), record(&fields, &[b' '; 4000])].concat();
    let error = read_pipe(&encrypted).unwrap_err();
    assert!(error.to_string().contains("encrypted by rosbag/AesCbcEncryptor"), "{error}");

    let fields: [(&str, &[u8]); 3] =
        [("compression", b"zstd"), ("op", &[5]), ("size", &[9, 0, 0, 0])];
    let bytes = bag(&[record(&fields, &[7; 99]), chunks(Packing::None)[0].clone()]);
    let (seconds, notes) = read_pipe(&bytes).unwrap();
    assert_eq!(seconds, [1, 2, 3, 4]);
    assert!(matches!(&notes[0], Note::Warning(w) if w.contains("(zstd)")), "{notes:?}");
}
