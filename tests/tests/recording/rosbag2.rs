//! rosbag2: databases and folders, whole, damaged and lying.

use std::path::{Path, PathBuf};

use imu_tests::databases::rosbag2;
use imu_tests::mcaps::{cdr, channel, chunk, imu, mcap, schema};
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

const IMU: &str = "sensor_msgs/msg/Imu";
const IMAGE: &str = "sensor_msgs/msg/Image";
const TOPICS: [(i64, &str, &str); 2] = [(1, "/imu", IMU), (7, "/camera", IMAGE)];

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Seconds of all samples, and notes.
fn read(path: &Path) -> Result<(Vec<i64>, Vec<Note>), Error> {
    let mut source = recording::open(path, &ReadOptions::default())?;
    let (mut seconds, mut block) = (Vec::new(), Block::default());
    while source.next_block(&mut block)? {
        assert_eq!(block.gyroscope.len(), block.accelerometer.len());
        seconds.extend(block.gyroscope.iter().map(|s| s.stamp_ns / 1_000_000_000));
    }
    assert!(!source.next_block(&mut block)?, "the end is the end");
    Ok((seconds, source.take_notes()))
}

fn read_bytes(bytes: &[u8]) -> Result<(Vec<i64>, Vec<Note>), Error> {
    let folder = folder();
    let path = folder.path().join("a.db3");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

/// A row of table messages: an Imu message at this second.
fn message(sec: u32) -> (i64, i64, Vec<u8>) {
    (1, i64::from(sec) * 1_000_000_000, cdr(sec, &Vec::from_iter((0..37).map(f64::from))))
}

/// A database of messages at these seconds.
fn database(page: usize, seconds: impl Iterator<Item = u32>) -> Vec<u8> {
    rosbag2(page, &TOPICS, &Vec::from_iter(seconds.map(message)))
}

fn warned(notes: &[Note], of: &str) -> bool {
    notes.iter().any(|note| matches!(note, Note::Warning(what) if what.contains(of)))
}

fn metadata(storage: &str, files: &[&str], messages: u64) -> String {
    let files: String = files.iter().map(|file| format!("    - {file}\n")).collect();
    format!(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: {storage}\n  \
         message_count: {messages}\n  relative_file_paths:\n{files}"
    )
}

#[test]
fn rows_of_many_pages_and_of_several_pages_each() {
    // Pages that hold many messages, few, and not a whole one.
    for (page, count) in [(65_536, 1000), (4096, 1000), (1024, 100), (512, 50)] {
        let (seconds, notes) = read_bytes(&database(page, 1..count)).unwrap();
        assert_eq!(seconds, Vec::from_iter(1..i64::from(count)), "pages of {page}");
        assert_eq!(notes, []);
    }
}

#[test]
fn long_messages_of_other_topics_are_passed_over() {
    let rows = [message(1), (7, 0, vec![1; 3_000_000]), message(2), (9, 0, vec![]), message(3)];
    let (seconds, notes) = read_bytes(&rosbag2(4096, &TOPICS, &rows)).unwrap();
    assert_eq!(seconds, [1, 2, 3]);
    assert!(warned(&notes, "1 messages of topics that it does not name"), "{notes:?}");
}

#[test]
fn messages_compressed_by_themselves() {
    let rows: Vec<_> = (1..10)
        .map(message)
        .map(|(topic, time, data)| {
            (topic, time, compress_to_vec(&data[..], CompressionLevel::Fastest))
        })
        .collect();
    let (seconds, notes) = read_bytes(&rosbag2(4096, &TOPICS, &rows)).unwrap();
    assert_eq!((seconds, notes), (Vec::from_iter(1..10), vec![]));
}

#[test]
fn a_database_through_a_pipe_or_compressed_is_read_from_a_copy() {
    let bytes = database(4096, 1..100);
    let stream = Box::new(std::io::Cursor::new(bytes.clone()));
    let mut source = recording::read_from("-".as_ref(), stream, &ReadOptions::default()).unwrap();
    let mut block = Block::default();
    assert!(source.next_block(&mut block).unwrap());
    assert_eq!(block.gyroscope.len(), 99);
    let folder = folder();
    let path = folder.path().join("a.db3.zstd");
    std::fs::write(&path, compress_to_vec(&bytes[..], CompressionLevel::Fastest)).unwrap();
    assert_eq!(read(&path).unwrap().0.len(), 99);
}

#[test]
fn a_database_cut_anywhere_keeps_its_whole_pages() {
    let bytes = database(1024, 1..30);
    for cut in (0..bytes.len()).step_by(64) {
        match read_bytes(&bytes[..cut]) {
            Ok((seconds, notes)) => {
                assert!(seconds.is_sorted() && seconds.iter().all(|s| (1..30).contains(s)));
                assert!(warned(&notes, "cut off"), "cut at {cut}: {notes:?}");
            }
            Err(error) => assert_eq!(error.exit_code(), 1, "cut at {cut}: {error}"),
        }
    }
}

#[test]
fn a_damaged_page_costs_its_rows() {
    let whole = database(4096, 1..1000);
    // The leaves of messages come behind the page of topics.
    let leaf = 4096 * 5;
    let mut kind = whole.clone();
    kind[leaf] = 0x77;
    let (seconds, notes) = read_bytes(&kind).unwrap();
    assert!((980..999).contains(&seconds.len()), "{}", seconds.len());
    assert!(seconds.is_sorted());
    assert!(warned(&notes, "1 of its pages"), "{notes:?}");

    let mut cell = whole;
    cell[leaf + 8..leaf + 10].fill(0xff);
    let (seconds, notes) = read_bytes(&cell).unwrap();
    assert_eq!(seconds.len(), 998);
    assert!(warned(&notes, "1 messages are lost"), "{notes:?}");
}

#[test]
fn a_tree_that_goes_in_circles_has_an_end() {
    let mut bytes = database(512, 1..50);
    // Its last page is the inner one; all of its children become itself.
    let last = bytes.len() - 512;
    let number = (bytes.len() / 512) as u32;
    let cells = usize::from(u16::from_be_bytes([bytes[last + 3], bytes[last + 4]]));
    for cell in 0..cells {
        let at = last + 12 + 2 * cell;
        let at = last + usize::from(u16::from_be_bytes([bytes[at], bytes[at + 1]]));
        bytes[at..at + 4].copy_from_slice(&number.to_be_bytes());
    }
    let (_, notes) = read_bytes(&bytes).unwrap();
    assert!(warned(&notes, "damaged"), "{notes:?}");
}

#[test]
fn other_databases_say_so() {
    let mut other = imu_tests::databases::Database::new(4096);
    let table = other.table(&[]);
    let error = read_bytes(&other.finish(&[("people", table, "CREATE TABLE people(name)")]));
    assert!(error.unwrap_err().to_string().contains("no recording of rosbag2"));
    assert!(read_bytes(b"SQLite format 3\0").unwrap_err().to_string().contains("cut off"));
    let mut size = database(4096, 1..3);
    size[16..18].fill(0);
    assert!(read_bytes(&size).unwrap_err().to_string().contains("pages are 0 bytes"));
}

/// An MCAP file of messages at these seconds.
fn mcap_of(seconds: impl Iterator<Item = u32>) -> Vec<u8> {
    let mut records = vec![schema(1, IMU), channel(0, 1, "/imu")];
    records.extend(seconds.map(|sec| imu(0, sec)));
    mcap(&[chunk(&records, "zstd")])
}

#[test]
fn files_of_a_folder_follow_each_other() {
    for storage in ["mcap", "sqlite3"] {
        for packed in [false, true] {
            let folder = folder();
            let ending = if storage == "mcap" { "mcap" } else { "db3" };
            let ending = format!("{ending}{}", if packed { ".zstd" } else { "" });
            // Two digits, so that the order of names is not that of numbers.
            let names = [8, 9, 10].map(|n| format!("a_{n}.{ending}"));
            for (name, start) in names.iter().zip([1, 11, 21]) {
                let bytes = match storage {
                    "mcap" => mcap_of(start..start + 10),
                    _ => database(4096, start..start + 10),
                };
                let bytes = if packed {
                    compress_to_vec(&bytes[..], CompressionLevel::Fastest)
                } else {
                    bytes
                };
                std::fs::write(folder.path().join(name), bytes).unwrap();
            }
            let all = Vec::from_iter(1..31);
            let (seconds, notes) = read(folder.path()).unwrap();
            assert_eq!(seconds, all);
            assert!(matches!(&notes[..], [Note::Warning(w)] if w.contains("no metadata.yaml")));

            let named: Vec<&str> = names.iter().map(String::as_str).collect();
            let yaml = folder.path().join("metadata.yaml");
            std::fs::write(&yaml, metadata(storage, &named, 30)).unwrap();
            assert_eq!(read(folder.path()).unwrap(), (all.clone(), vec![]));
            std::fs::write(&yaml, metadata(storage, &named, 31)).unwrap();
            let (_, notes) = read(folder.path()).unwrap();
            assert!(warned(&notes, "should hold 31 messages"), "{notes:?}");

            // One that is damaged from its start on.
            std::fs::write(folder.path().join(&names[1]), b"rubbish").unwrap();
            let (seconds, notes) = read(folder.path()).unwrap();
            assert_eq!(seconds, Vec::from_iter((1..11).chain(21..31)));
            assert!(warned(&notes, &names[1]), "{notes:?}");

            std::fs::remove_file(folder.path().join(&names[1])).unwrap();
            let error = read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(&names[1]) && error.contains("missing"), "{error}");
        }
    }
}

#[test]
fn folders_that_are_none_say_so() {
    let empty = folder();
    let error = read(empty.path()).unwrap_err();
    assert!(error.to_string().contains("is a folder without a recording"), "{error}");
    let yaml: PathBuf = empty.path().join("metadata.yaml");
    for (text, said) in [
        ("", "is not what rosbag2 writes"),
        (&metadata("magic", &["a"], 1), "stored as magic"),
        (&metadata("mcap", &["a.mcap"], 1), "a.mcap is missing"),
    ] {
        std::fs::write(&yaml, text).unwrap();
        let error = read(empty.path()).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}
