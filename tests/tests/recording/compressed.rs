//! Recordings inside gzip and Zstandard: the same samples, honest progress, and no silent damage.

use std::io::Write as _;

use imu_tests::recordings::{Folder, simulated};
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions};

const SCENE: &str = "\
rate_hz = 100
duration = \"300s\"
[gyroscope]
noise_density = 0.01
random_walk = 0.001
[accelerometer]
noise_density = 0.02
random_walk = 0.002
";

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut to = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    to.write_all(bytes).unwrap();
    to.finish().unwrap()
}

fn zst(bytes: &[u8]) -> Vec<u8> {
    ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
}

/// All samples and warnings; asserts that progress never goes back and ends at the file's length.
fn read(path: &str) -> Result<(Block, Vec<String>), Error> {
    let mut source = recording::open(path.as_ref(), &ReadOptions::default())?;
    let total = std::fs::metadata(path).unwrap().len();
    assert_eq!(source.bytes_total(), Some(total));
    let (mut all, mut block, mut before) = (Block::default(), Block::default(), 0);
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
        let now = source.bytes_read();
        assert!(before <= now && now <= total);
        before = now;
    }
    let warnings = source.take_notes().into_iter().filter_map(|note| match note {
        Note::Warning(what) => Some(what),
        Note::Info(_) => None,
    });
    Ok((all, warnings.collect()))
}

#[test]
fn any_recording_is_read_through_compression() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    for name in ["a.bag", "a.csv"] {
        let bytes = std::fs::read(folder.record(name, &block)).unwrap();
        for (ending, packed) in [("gz", gz(&bytes)), ("zst", zst(&bytes))] {
            let path = folder.put(&format!("{name}.{ending}"), packed);
            let (all, warnings) = read(&path).unwrap();
            assert_eq!((all, warnings), (block.clone(), vec![]), "{path}");
        }
    }
}

#[test]
fn half_a_file_gives_half_of_its_samples_and_a_warning() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    let count = block.gyroscope.len();
    for name in ["a.bag", "a.csv"] {
        let bytes = std::fs::read(folder.record(name, &block)).unwrap();
        for (ending, packed) in [("gz", gz(&bytes)), ("zst", zst(&bytes))] {
            let path = folder.put(&format!("{name}.{ending}"), &packed[..packed.len() / 2]);
            let (all, warnings) = read(&path).unwrap();
            let read = all.gyroscope.len();
            assert_eq!(all.gyroscope[..], block.gyroscope[..read]);
            // Zstandard's blocks are 128 KiB, about 1000 rows.
            assert!(read > count / 2 - 2000 && read < count / 2 + 2000, "{path}: {read}");
            assert!(
                warnings.iter().any(|w| w.contains("is cut off: its compressed")),
                "{warnings:?}"
            );
        }
    }
}

#[test]
fn nonsense_after_damage_is_told_as_damage() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    let bytes = std::fs::read(folder.record("a.csv", &block)).unwrap();
    for (ending, mut packed) in [("gz", gz(&bytes)), ("zst", zst(&bytes))] {
        let middle = packed.len() / 2;
        packed[middle..middle + 8].fill(0x55);
        let path = folder.put(&format!("a.csv.{ending}"), packed);
        let (all, warnings) = read(&path).unwrap();
        // Of what the damage left readable, some digits may be wrong, which nobody can tell.
        assert!(all.gyroscope.len() > block.gyroscope.len() / 2 - 2000, "{}", all.gyroscope.len());
        assert_eq!(all.gyroscope[..10_000], block.gyroscope[..10_000]);
        assert!(warnings.iter().any(|w| w.contains("is damaged")), "{warnings:?}");
    }
}

#[test]
fn what_is_in_no_recording_is_one_sentence() {
    let folder = Folder::new();
    let cut = folder.put("a.csv.gz", &gz(b"t,gx,gy,gz\n1,2,3,4\n")[..8]);
    let text = folder.put("b.gz", gz(b"hello"));
    let nothing = folder.put("c.zst", zst(b""));
    for (path, part) in [(cut, "is cut off"), (text, "no row of numbers"), (nothing, "is empty")] {
        let error = recording::open(path.as_ref(), &ReadOptions::default()).err().unwrap();
        assert!(error.to_string().contains(part), "{error}");
        assert_eq!(error.exit_code(), 1);
    }
}
