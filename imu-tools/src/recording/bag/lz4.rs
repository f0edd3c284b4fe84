//! LZ4 frames, block by block, and of a block that was cut off whatever can still be unpacked.
//!
//! ROS 1 compresses a chunk as one frame, whose blocks hold up to 1 MiB (rosbag's roslz4); a whole
//! chunk is then a single block. Decoders give nothing of a block that lacks its end, so a recorder
//! that died would cost a chunk: this one gives every byte before the cut. Formats: LZ4 Frame
//! Format 1.6.x and LZ4 Block Format (Collet), with linked blocks, and checksums of blocks and
//! content.
//!
//! Memory: one block packed and one unpacked, at most 4 MiB each, whatever the frame claims.

use std::hash::Hasher as _;

use twox_hash::XxHash32;

use super::unpack::Packed;
use crate::error::Error;

/// First bytes of a frame.
pub const MAGIC: [u8; 4] = [0x04, 0x22, 0x4d, 0x18];

/// Matches reach back so far at most: what a decoder of linked blocks must keep.
pub const HISTORY: usize = 64 * 1024;

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// There is more.
    More,
    /// The end, and all is well.
    End,
    /// The end, but what was unpacked is not what was packed.
    WrongSum,
    /// The data ended before the frame did.
    Short,
    /// This is no LZ4 frame, or no longer.
    Damaged,
}

/// What a frame says of itself.
#[derive(Clone, Debug)]
struct Frame {
    linked: bool,
    block_sums: bool,
    largest_block: usize,
    /// Over all that was unpacked, where the frame has it.
    content: Option<XxHash32>,
}

/// A frame being unpacked.
#[derive(Clone, Debug, Default)]
pub struct Lz4 {
    frame: Option<Frame>,
    /// The block at hand.
    block: Vec<u8>,
}

impl Lz4 {
    /// Unpacks the next block and appends it to `out`, which holds at least [`HISTORY`] of what was
    /// unpacked before.
    pub fn step(&mut self, packed: &mut Packed<'_>, out: &mut Vec<u8>) -> Result<Step, Error> {
        let Some(frame) = &mut self.frame else {
            return self.begin(packed);
        };
        let start = out.len();
        self.block.clear();
        if !packed.append(4, &mut self.block)? {
            return Ok(Step::Short);
        }
        let size = word(&self.block);
        if size == 0 {
            let Some(sum) = &frame.content else { return Ok(Step::End) };
            self.block.clear();
            let there = packed.append(4, &mut self.block)?;
            return Ok(match there {
                false => Step::Short,
                true if word(&self.block) == sum.finish_32() => Step::End,
                true => Step::WrongSum,
            });
        }
        let (stored, size) = (size >> 31 == 1, (size & 0x7fff_ffff) as usize);
        if size > frame.largest_block {
            return Ok(Step::Damaged);
        }
        self.block.clear();
        let whole = packed.append(size, &mut self.block)?;
        let unpacked = if stored {
            out.extend_from_slice(&self.block);
            true
        } else {
            let oldest = if frame.linked { 0 } else { start };
            unpack_block(&self.block, out, oldest, start + frame.largest_block)
        };
        if let (Some(sum), Some(new)) = (&mut frame.content, out.get(start..)) {
            sum.write(new);
        }
        if !whole {
            return Ok(Step::Short);
        }
        if !unpacked {
            return Ok(Step::Damaged);
        }
        if frame.block_sums {
            let sum = XxHash32::oneshot(0, &self.block);
            self.block.clear();
            if !packed.append(4, &mut self.block)? {
                return Ok(Step::Short);
            }
            if word(&self.block) != sum {
                out.truncate(start);
                return Ok(Step::Damaged);
            }
        }
        Ok(Step::More)
    }

    /// Reads the frame's header.
    fn begin(&mut self, packed: &mut Packed<'_>) -> Result<Step, Error> {
        let header = &mut self.block;
        header.clear();
        if !packed.append(6, header)? {
            return Ok(Step::Short);
        }
        let &[_, _, _, _, flags, block] = header.as_slice() else { return Ok(Step::Damaged) };
        let has = |bit: u8| flags >> bit & 1 == 1;
        let largest_block = match block >> 4 {
            4 => 64 << 10,
            5 => 256 << 10,
            6 => 1 << 20,
            7 => 4 << 20,
            _ => return Ok(Step::Damaged),
        };
        if !header.starts_with(&MAGIC) || flags >> 6 != 1 {
            return Ok(Step::Damaged);
        }
        // Size of the content, number of a dictionary, and the sum over all but the magic number.
        let rest = 8 * usize::from(has(3)) + 4 * usize::from(has(0)) + 1;
        if !packed.append(rest, header)? {
            return Ok(Step::Short);
        }
        let Some((&sum, [_, _, _, _, described @ ..])) = header.split_last() else {
            return Ok(Step::Damaged);
        };
        if (XxHash32::oneshot(0, described) >> 8) as u8 != sum || has(0) {
            return Ok(Step::Damaged);
        }
        self.frame = Some(Frame {
            linked: !has(5),
            block_sums: has(4),
            largest_block,
            content: has(2).then(|| XxHash32::with_seed(0)),
        });
        Ok(Step::More)
    }
}

/// The first four bytes as a number.
fn word(bytes: &[u8]) -> u32 {
    bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b))
}

/// Appends what `block` unpacks to; `out` grows to `limit` at most, and nothing before `oldest` is
/// referred to. `false` where the block is malformed or cut off: what comes before is there.
fn unpack_block(mut block: &[u8], out: &mut Vec<u8>, oldest: usize, limit: usize) -> bool {
    loop {
        let Some((&token, rest)) = block.split_first() else { return false };
        block = rest;
        let Some(literals) = length(token >> 4, &mut block) else { return false };
        let here = literals.min(block.len()).min(limit.saturating_sub(out.len()));
        let (text, rest) = block.split_at(here);
        out.extend_from_slice(text);
        block = rest;
        if here < literals {
            return false;
        }
        if block.is_empty() {
            return true; // the last sequence has no match
        }
        let Some((back, rest)) = block.split_first_chunk() else { return false };
        block = rest;
        let back = usize::from(u16::from_le_bytes(*back));
        if back == 0 || back > out.len() - oldest.min(out.len()) {
            return false;
        }
        let Some(matching) = length(token & 15, &mut block) else { return false };
        let matching = matching + 4;
        if matching > limit.saturating_sub(out.len()) {
            return false;
        }
        // A match may overlap what it makes: then it repeats.
        let (from, mut left) = (out.len() - back, matching);
        while left > 0 {
            let n = left.min(out.len() - from);
            out.extend_from_within(from..from + n);
            left -= n;
        }
    }
}

/// A length of which `nibble` is the beginning; `None` where the block ends in it.
#[inline]
fn length(nibble: u8, block: &mut &[u8]) -> Option<usize> {
    let mut length = usize::from(nibble);
    if nibble == 15 {
        loop {
            let (&more, rest) = block.split_first()?;
            *block = rest;
            length += usize::from(more);
            if more != 255 {
                break;
            }
        }
    }
    Some(length)
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};

    use super::*;
    use crate::recording::input::Input;

    /// Text that packs well here and not at all there.
    fn text() -> Vec<u8> {
        let mut state = 1_u32;
        let mut text = Vec::new();
        for i in 0..60_000_u32 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let word = if i / 5_000 % 2 == 0 { state } else { i / 100 };
            text.extend(word.to_le_bytes());
        }
        text
    }

    fn unpack(packed: &[u8]) -> (Vec<u8>, Step) {
        let bytes = Box::new(std::io::Cursor::new(packed.to_vec()));
        let mut input = Input::pipe("a".as_ref(), bytes);
        let mut left = packed.len() as u64;
        let (mut lz4, mut out) = (Lz4::default(), Vec::new());
        loop {
            let mut packed = Packed { input: &mut input, left: &mut left };
            match lz4.step(&mut packed, &mut out).unwrap() {
                Step::More => {}
                end => return (out, end),
            }
        }
    }

    fn frames() -> Vec<Vec<u8>> {
        let mut frames = Vec::new();
        for size in [BlockSize::Max64KB, BlockSize::Max256KB, BlockSize::Max1MB] {
            for mode in [BlockMode::Independent, BlockMode::Linked] {
                for sums in [false, true] {
                    let info = FrameInfo::new()
                        .block_size(size)
                        .block_mode(mode)
                        .block_checksums(sums)
                        .content_checksum(sums)
                        .content_size(sums.then(|| text().len() as u64));
                    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
                    encoder.write_all(&text()).unwrap();
                    frames.push(encoder.finish().unwrap());
                }
            }
        }
        frames
    }

    #[test]
    fn frames_of_another_program_are_unpacked() {
        for frame in frames() {
            let (out, end) = unpack(&frame);
            assert_eq!(end, Step::End);
            assert!(out == text());
        }
    }

    #[test]
    fn a_cut_gives_every_byte_before_it() {
        for frame in frames() {
            let mut before = 0;
            for cut in (0..frame.len()).step_by(997) {
                let (out, end) = unpack(&frame[..cut]);
                assert_eq!(end, Step::Short);
                assert!(text().starts_with(&out));
                // No text packs to less than a 255th; here nothing packs to more than itself, and
                // headers and a sequence at most are not yet text.
                assert!(out.len() >= before && out.len() + 200 >= cut, "{cut} {}", out.len());
                before = out.len();
            }
        }
    }

    #[test]
    fn damage_is_seen_and_never_grows() {
        for frame in frames() {
            for at in (0..frame.len()).step_by(499) {
                let mut damaged = frame.clone();
                damaged[at] ^= 0x55;
                let (out, end) = unpack(&damaged);
                let sums = frame[4] >> 2 & 1 == 1;
                assert!(!sums || end != Step::End, "at {at}");
                assert!(out.len() <= 2 * text().len() + (2 << 20));
            }
        }
    }

    #[test]
    fn a_claim_costs_no_memory() {
        let mut frame = frames()[8][..7].to_vec();
        frame.extend((1_u32 << 20).to_le_bytes());
        frame.push(0);
        let (out, end) = unpack(&frame);
        assert_eq!((out.len(), end), (0, Step::Short));
        frame[7..11].copy_from_slice(&0x7fff_ffff_u32.to_le_bytes());
        assert_eq!(unpack(&frame).1, Step::Damaged);
    }
}
