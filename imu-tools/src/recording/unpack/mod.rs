//! What stands between a file's bytes and a format: gzip, Zstandard, UTF-16, in any order.
//!
//! [`unpack`] looks at the first bytes and puts a [`Layer`] around an [`Input`] for each wrapping
//! that it finds, so that readers see what is inside, front to back, in bounded memory.
//! [`Unpacked`] goes around the reader: progress is that of the file, not of what is inside, and
//! damage becomes a warning whether the reader noticed it or not.

mod gzip;
mod utf16;
mod zstd;

use std::fmt::Display;
use std::io::{self, Read};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::input::Input;
use super::{Block, Note, SampleKind, Source, Stream, zstandard};
use crate::error::Error;

/// So many wrappings in each other are enough for anything but an attack.
const DEEPEST: usize = 4;

/// Why there is nothing more to read.
enum Stop {
    /// The bytes are not what they should be: what is wrong, in a sentence.
    Damage(String),
    /// The system refused.
    Refused(Error),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Refused(error)
    }
}

/// Turns the bytes of an [`Input`] into those of what is in it.
trait Unpack: Send {
    /// As [`Read::read`]: 0 at the end.
    fn read(&mut self, to: &mut [u8]) -> Result<usize, Stop>;

    /// The bytes that are unpacked.
    fn input(&self) -> &Input;
}

/// The sentence for a file that ends too early.
fn cut_off(input: &Input) -> String {
    format!(
        "{} is cut off: its compressed data end after {} bytes in the middle of a piece, and what \
         followed is lost",
        input.path().display(),
        input.offset()
    )
}

/// The sentence for a file that cannot be decompressed from about byte `at` on, and why.
fn damaged_near(input: &Input, at: u64, why: &dyn Display) -> String {
    format!(
        "{} is damaged near byte {at} of its compressed data ({why}): what follows is lost",
        input.path().display()
    )
}

/// One wrapping, shared by the [`Input`] that reads from it and the [`Unpacked`] that watches it.
#[derive(Clone)]
struct Layer(Arc<Mutex<State>>);

struct State {
    unpack: Box<dyn Unpack>,
    /// Nothing more comes.
    ended: bool,
    damage: Option<String>,
    /// There is damage: for the reader of what is inside.
    damaged: Arc<AtomicBool>,
}

impl Layer {
    fn new(unpack: impl Unpack + 'static) -> Self {
        let unpack = Box::new(unpack);
        let damaged = Arc::default();
        Self(Arc::new(Mutex::new(State { unpack, ended: false, damage: None, damaged })))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is wrong with it, in a sentence, when all of it was read.
    fn damage_to_the_end(&mut self) -> Option<String> {
        let mut passed = vec![0; 64 * 1024];
        while self.read(&mut passed).is_ok_and(|n| n > 0) {}
        self.lock().damage.clone()
    }
}

impl Read for Layer {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let mut state = self.lock();
        if state.ended {
            return Ok(0);
        }
        match state.unpack.read(to) {
            Ok(n) => {
                state.ended = n == 0 && !to.is_empty();
                Ok(n)
            }
            Err(Stop::Damage(what)) => {
                state.ended = true;
                state.damage = Some(what);
                state.damaged.store(true, Ordering::Relaxed);
                Ok(0)
            }
            Err(Stop::Refused(Error::Io { source, .. })) => Err(source),
            Err(Stop::Refused(other)) => Err(io::Error::other(other)),
        }
    }
}

/// The wrappings of a file, the outermost first.
#[derive(Default)]
pub struct Layers(Vec<Layer>);

/// Takes off all wrappings.
///
/// # Errors
/// When the file cannot be read, or is wrapped again and again.
pub fn unpack(mut input: Input) -> Result<(Input, Layers), Error> {
    let mut layers = Layers::default();
    loop {
        input.fill(4)?;
        let path = input.path().to_owned();
        let layer = match input.at_hand() {
            [0x1f, 0x8b, ..] => Layer::new(gzip::Gzip::new(input)),
            // A frame, or one to be passed over.
            start if start.starts_with(&zstandard::MAGIC) => Layer::new(zstd::Zstd::new(input)),
            [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..] => Layer::new(zstd::Zstd::new(input)),
            [0xff, 0xfe, ..] => Layer::new(utf16::Utf16::new(input, u16::from_le_bytes)),
            [0xfe, 0xff, ..] => Layer::new(utf16::Utf16::new(input, u16::from_be_bytes)),
            _ => return Ok((input, layers)),
        };
        if layers.0.len() == DEEPEST {
            return Err(Error::data(format!(
                "{} is compressed more than {DEEPEST} times: decompress it first",
                path.display()
            )));
        }
        let damaged = layer.lock().damaged.clone();
        layers.0.push(layer.clone());
        input = Input::unpacked(&path, Box::new(layer), damaged);
    }
}

impl Layers {
    /// The reader with these around it; where there are none, the reader itself.
    ///
    /// # Errors
    /// Those of the reader, with the damage that they come from.
    pub fn around(
        mut self,
        source: Result<Box<dyn Source>, Error>,
    ) -> Result<Box<dyn Source>, Error> {
        match source {
            Err(error) => Err(match (self.damage_to_the_end(), error) {
                (Some(damage), Error::Data(what)) => Error::data(format!("{damage}; {what}")),
                (_, error) => error,
            }),
            Ok(source) if self.0.is_empty() => Ok(source),
            Ok(source) => {
                Ok(Box::new(Unpacked { source, layers: self, ended: false, told: false }))
            }
        }
    }

    fn damage_to_the_end(&mut self) -> Option<String> {
        self.0.iter_mut().rev().find_map(Layer::damage_to_the_end)
    }

    fn damage(&self) -> Option<String> {
        self.0.iter().find_map(|layer| layer.lock().damage.clone())
    }
}

/// The reader of what was unpacked.
struct Unpacked {
    source: Box<dyn Source>,
    layers: Layers,
    ended: bool,
    /// The damage was told.
    told: bool,
}

impl Source for Unpacked {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        if self.ended {
            block.clear();
            return Ok(false);
        }
        match self.source.next_block(block) {
            // Between damage and its discovery there may be nonsense, at which the reader stops.
            Err(Error::Data(_)) if self.layers.damage_to_the_end().is_some() => {
                self.ended = true;
                Ok(!block.is_empty())
            }
            other => other,
        }
    }

    fn streams(&self) -> Vec<Stream> {
        self.source.streams()
    }

    fn gyroscope(&self) -> &str {
        self.source.gyroscope()
    }

    fn accelerometer(&self) -> &str {
        self.source.accelerometer()
    }

    fn take_notes(&mut self) -> Vec<Note> {
        let mut notes = self.source.take_notes();
        if !self.told
            && let Some(damage) = self.layers.damage()
        {
            self.told = true;
            notes.push(Note::Warning(damage));
        }
        notes
    }

    fn samples(&self) -> Option<SampleKind> {
        self.source.samples()
    }

    fn bytes_read(&self) -> u64 {
        self.layers.0.first().map_or(0, |outermost| outermost.lock().unpack.input().offset())
    }

    fn bytes_total(&self) -> Option<u64> {
        self.layers.0.first().and_then(|outermost| outermost.lock().unpack.input().len())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::path::Path;

    use super::*;

    fn gz(bytes: &[u8]) -> Vec<u8> {
        let mut to = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        to.write_all(bytes).unwrap();
        to.finish().unwrap()
    }

    fn zst(bytes: &[u8]) -> Vec<u8> {
        ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
    }

    /// What is in `bytes`, and the damage that was found.
    fn unpacked(bytes: Vec<u8>) -> (Vec<u8>, Option<String>) {
        let pipe = Input::pipe(Path::new("a"), Box::new(io::Cursor::new(bytes)));
        let (mut input, layers) = unpack(pipe).unwrap();
        let mut inside = Vec::new();
        while input.fill(1).unwrap() {
            inside.extend_from_slice(input.at_hand());
            input.consume(usize::MAX);
        }
        (inside, layers.damage())
    }

    /// Text that compresses as numbers do, longer than a buffer.
    fn text() -> Vec<u8> {
        let rows =
            (0..60_000_u64).map(|i| format!("{},{}\n", i, i.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        rows.collect::<String>().into_bytes()
    }

    #[test]
    fn whole_files_come_out_whole_also_one_after_the_other() {
        let text = text();
        let (a, b) = text.split_at(700_000);
        for pack in [gz, zst] {
            assert_eq!(unpacked(pack(&text)), (text.clone(), None));
            assert_eq!(unpacked([pack(a), pack(b), pack(b"")].concat()), (text.clone(), None));
            assert_eq!(unpacked(pack(&pack(&text))), (text.clone(), None));
        }
        assert_eq!(unpacked(zst(&gz(&text))), (text.clone(), None));
        // Tapes and disks are padded with zeros.
        assert_eq!(unpacked([gz(&text), vec![0; 1000]].concat()), (text.clone(), None));
        let skipped = [&[0x5a, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 1, 2, 3], &zst(&text)[..]].concat();
        assert_eq!(unpacked(skipped), (text.clone(), None));
        assert_eq!(unpacked(text.clone()), (text, None));
    }

    #[test]
    fn all_before_a_cut_comes_out() {
        let text = text();
        for pack in [gz, zst] {
            let packed = pack(&text);
            for tenths in 1..10 {
                let cut = packed.len() * tenths / 10;
                let (inside, damage) = unpacked(packed[..cut].to_vec());
                assert!(text.starts_with(&inside));
                // Zstandard's blocks hold 128 KiB at most; numbers compress evenly.
                let expected = text.len() * tenths / 10;
                assert!(inside.len() + 160 * 1024 > expected, "{} of {expected}", inside.len());
                assert!(damage.unwrap().contains("is cut off"));
            }
            for cut in 4..12 {
                assert!(unpacked(packed[..cut].to_vec()).1.unwrap().contains("is cut off"));
            }
        }
    }

    #[test]
    fn damage_is_found_and_what_stands_before_it_comes_out() {
        let text = text();
        for pack in [gz, zst] {
            let mut packed = pack(&text);
            let middle = packed.len() / 2;
            packed[middle] ^= 0x10;
            packed[middle + 1] ^= 0x10;
            let (inside, damage) = unpacked(packed);
            let same = inside.iter().zip(&text).take_while(|(a, b)| a == b).count();
            assert!(same + 160 * 1024 > text.len() / 2, "{same}");
            assert!(damage.unwrap().contains("damaged"));
        }
        let (inside, damage) = unpacked([&gz(&text)[..], b"rubbish"].concat());
        assert_eq!(inside, text);
        assert!(damage.unwrap().contains("7 bytes"));
    }

    #[test]
    fn utf_16_becomes_utf_8() {
        let text = "t,gyro_x [°/s]\r\n\u{1f600},2\n".repeat(40_000);
        let big: Vec<u8> = "\u{feff}"
            .encode_utf16()
            .chain(text.encode_utf16())
            .flat_map(u16::to_be_bytes)
            .collect();
        let little: Vec<u8> = big.chunks(2).flat_map(|c| [c[1], c[0]]).collect();
        for bytes in [big, little] {
            assert_eq!(unpacked(bytes.clone()), (text.clone().into_bytes(), None));
            let (inside, damage) = unpacked(bytes[..bytes.len() - 1].to_vec());
            assert!(text.as_bytes().starts_with(&inside));
            assert!(damage.unwrap().contains("is cut off"));
        }
    }

    #[test]
    fn wrappings_without_end_are_refused() {
        let mut packed = b"x".to_vec();
        for _ in 0..6 {
            packed = gz(&packed);
        }
        let pipe = Input::pipe(Path::new("a"), Box::new(io::Cursor::new(packed)));
        let error = unpack(pipe).err().unwrap();
        assert!(error.to_string().contains("more than 4 times"), "{error}");
    }
}
