//! From bytes to messages: what comes next, whether it can be trusted, and where to go on after
//! bytes that are none.
//!
//! Nothing in a log checks its bytes, but its data is hard to mistake: the size of a data message
//! must be the one that the format of its topic has, and another message must be able to start
//! behind it. Where none can, the damage may have begun within: such data is not used.

use super::definitions::{Definitions, NAME, Subscribed};
use super::format::Defined;
use super::remarks::Remarks;
use crate::error::Error;
use crate::recording::input::Input;

/// Bytes of a message's size and kind.
const HEADER: usize = 3;

/// Bytes of the longest message.
const LONGEST: usize = HEADER + 65_535;

/// Bytes that show whether a message can start there.
const LOOK: usize = HEADER + 2 + NAME + 8;

/// Bytes searched at once for the next message.
const WINDOW: usize = 4 * LONGEST;

/// What a synchronization message holds.
const SYNC: [u8; 8] = [0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12];

/// What a message is to a reader of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// Data of the topic at this place.
    Data(usize),
    /// The topic at this place is in the log.
    Subscribed(usize),
    /// Something else.
    Other,
}

/// How far bytes can be trusted to be a message, by themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Trust {
    /// They are none.
    None,
    /// Their size and kind can be a message's.
    Doubtful,
    /// Their words are those of their kind.
    Words,
    /// Their size is that of their topic, or all of them are as they must be.
    Size,
}

/// The messages of a log, front to back.
pub struct Messages {
    input: Input,
    /// What the messages so far have said of the log.
    pub definitions: Definitions,
    /// What is strange.
    pub remarks: Remarks,
    /// Where data was appended, ahead of us.
    appended: Vec<u64>,
    /// Bytes of the message that is at hand.
    length: usize,
}

impl Messages {
    /// Starts behind the header of the file, or anywhere between messages.
    pub fn new(input: Input, definitions: Definitions) -> Self {
        let appended = Vec::new();
        Self { input, definitions, remarks: Remarks::default(), appended, length: 0 }
    }

    /// Where the bytes come from.
    pub fn input(&self) -> &Input {
        &self.input
    }

    /// Where the bytes come from, as long as no message is at hand.
    pub fn input_mut(&mut self) -> &mut Input {
        &mut self.input
    }

    /// The fields of the data message at hand.
    #[inline]
    pub fn data(&self) -> &[u8] {
        self.input.at_hand().get(HEADER + 2..self.length).unwrap_or_default()
    }

    /// Goes to the next message, which then is at hand; `None` at the end.
    ///
    /// # Errors
    /// When the file cannot be read, or says that it must not be by those who know no more of the
    /// format than we.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Message>, Error> {
        self.input.consume(std::mem::take(&mut self.length));
        loop {
            self.input.fill(HEADER)?;
            let Some((size, kind)) = header(self.input.at_hand()) else {
                let rest = self.input.at_hand().len();
                self.input.consume(rest);
                self.remarks.cut |= rest > 0;
                return Ok(None);
            };
            let length = HEADER + size;
            if !self.appended.is_empty() && self.reaches_appended(length)? {
                continue;
            }
            let whole = self.input.fill(length)?;
            let trust = self.judge(self.input.at_hand());
            if !whole {
                if !self.recover(true)? {
                    return Ok(None);
                }
            } else if self.is_believed(trust, length)? {
                self.length = length;
                return self.take(kind).map(Some);
            } else if !self.recover(false)? {
                return Ok(None);
            }
        }
    }

    /// What the message at hand says.
    #[inline]
    fn take(&mut self, kind: u8) -> Result<Message, Error> {
        let body = self.input.at_hand().get(HEADER..self.length).unwrap_or_default();
        match kind {
            b'D' => {
                let number = body.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes));
                if let Some(place) = self.definitions.place(number) {
                    self.definitions.count(place);
                    return Ok(Message::Data(place));
                }
                self.remarks.undescribed += 1;
            }
            b'A' => match self.definitions.subscribe(body) {
                Subscribed::New(place) => return Ok(Message::Subscribed(place)),
                Subscribed::Known => {}
                Subscribed::Contradicts | Subscribed::Refused => self.remarks.refused += 1,
            },
            b'F' => {
                let refused = self.definitions.define(body) != Defined::Known;
                self.remarks.refused += u64::from(refused);
            }
            b'O' => {
                let ms = body.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes));
                self.remarks.dropouts += 1;
                self.remarks.dropout_ms += u64::from(ms);
            }
            b'B' => self.flags()?,
            b'I' | b'M' | b'P' | b'Q' | b'R' | b'L' | b'C' | b'S' => {}
            _ => self.remarks.unknown_kinds += 1,
        }
        Ok(Message::Other)
    }

    /// Takes the flags: which features the log uses, and where data was appended to it.
    fn flags(&mut self) -> Result<(), Error> {
        let body = self.input.at_hand().get(HEADER..self.length).unwrap_or_default();
        let Some((incompatible, offsets)) =
            body.get(8..).and_then(|rest| rest.split_first_chunk::<8>())
        else {
            return Ok(());
        };
        let [first, rest @ ..] = incompatible;
        if first & !1 != 0 || rest.iter().any(|&bits| bits != 0) {
            return Err(Error::data(format!(
                "{} uses a feature of ULog newer than this program (incompatible flags \
                 {incompatible:02x?}): convert it with the program that wrote it",
                self.input.path().display()
            )));
        }
        if first & 1 == 1 {
            let here = self.input.offset();
            let offsets = offsets.chunks_exact(8).take(3);
            let offsets = offsets.filter_map(|b| Some(u64::from_le_bytes(*b.first_chunk()?)));
            self.appended = offsets.filter(|&offset| offset > here).collect();
            self.appended.sort_unstable();
        }
        Ok(())
    }

    /// Whether the next message, of this length, reaches into appended data: then it was cut off,
    /// and we go on at that data.
    fn reaches_appended(&mut self, length: usize) -> Result<bool, Error> {
        let here = self.input.offset();
        self.appended.retain(|&edge| edge > here);
        let Some(&edge) = self.appended.first() else { return Ok(false) };
        if here + length as u64 <= edge {
            return Ok(false);
        }
        self.remarks.cut_before_appended = true;
        self.input.skip(edge - here)?;
        Ok(true)
    }

    /// Whether a whole message of this trust is taken for one, by what follows it.
    #[inline]
    fn is_believed(&mut self, trust: Trust, length: usize) -> Result<bool, Error> {
        if trust == Trust::None {
            return Ok(false);
        }
        self.input.fill(length + LOOK)?;
        let bytes = self.input.at_hand();
        let edge = self.appended.first().map_or(usize::MAX, |edge| {
            usize::try_from(edge - self.input.offset()).unwrap_or(usize::MAX)
        });
        let next = bytes.get(length..bytes.len().min(edge)).unwrap_or_default();
        if self.judge(next) != Trust::None {
            return Ok(true);
        }
        self.is_believed_before_damage(trust, length)
    }

    /// As above, where no message follows. Words speak for themselves unless they have swallowed
    /// another message; numbers may be a part of the damage.
    #[cold]
    fn is_believed_before_damage(&mut self, trust: Trust, length: usize) -> Result<bool, Error> {
        self.input.fill(length + LONGEST + LOOK)?;
        let bytes = self.input.at_hand();
        let swallowed = (1..length).any(|at| self.is_sound(bytes.get(at..).unwrap_or_default()));
        Ok(trust == Trust::Words && !swallowed)
    }

    /// Searches for the next message that can be trusted, behind the first byte at hand; `false`
    /// at the end. `cut`: what is at hand may be a message that the end of the file has cut off.
    #[cold]
    fn recover(&mut self, cut: bool) -> Result<bool, Error> {
        let start = self.input.offset();
        let mut from = 1;
        loop {
            let filled = self.input.fill(WINDOW)?;
            let here = self.input.offset();
            let bytes = self.input.at_hand();
            // Behind the last one, a message and its successor may be out of sight.
            let last = if filled { bytes.len() - LONGEST - LOOK } else { bytes.len() };
            let edge = self.appended.first().and_then(|edge| usize::try_from(edge - here).ok());
            let found = (from..last)
                .find(|&at| edge == Some(at) || self.is_sound(bytes.get(at..).unwrap_or_default()));
            self.input.consume(found.unwrap_or(last));
            let lost = self.input.offset() - start;
            if found.is_some() {
                self.remarks.damaged(start, lost);
                return Ok(true);
            }
            if !filled {
                if cut {
                    self.remarks.cut = true;
                } else {
                    self.remarks.damaged_to_the_end(start, lost);
                }
                return Ok(false);
            }
            from = 0;
        }
    }

    /// Whether a whole message starts here that can be trusted, and another can follow.
    fn is_sound(&self, bytes: &[u8]) -> bool {
        let Some((size, _)) = header(bytes) else { return false };
        bytes.len() >= HEADER + size
            && self.judge(bytes) >= Trust::Words
            && self.judge(bytes.get(HEADER + size..).unwrap_or_default()) != Trust::None
    }

    /// How far these bytes can be trusted to start with a message; what is out of sight speaks
    /// neither for nor against them.
    #[inline]
    fn judge(&self, bytes: &[u8]) -> Trust {
        let Some((size, kind)) = header(bytes) else { return Trust::Doubtful };
        let body = bytes.get(HEADER..).unwrap_or_default();
        let body = body.get(..size).unwrap_or(body);
        let short = body.len() < size;
        let sized = |good| if good { Trust::Doubtful } else { Trust::None };
        match kind {
            b'D' => {
                let Some(number) = body.first_chunk() else { return sized(size >= 2) };
                let place = self.definitions.place(u16::from_le_bytes(*number));
                match place.and_then(|place| self.definitions.at(place)?.lengths) {
                    Some((least, most)) if (least..=most).contains(&(size - 2)) => Trust::Size,
                    Some(_) => Trust::None,
                    None => sized(size >= 2),
                }
            }
            b'S' if size != SYNC.len() || !SYNC.starts_with(body) => Trust::None,
            b'S' if short => Trust::Doubtful,
            b'S' => Trust::Size,
            b'A' => match body.get(3..) {
                Some(name) if size > 3 && !short => self.judge_topic(name),
                _ => sized(size > 3),
            },
            b'F' => judge_format(body, short),
            b'I' | b'P' => judge_value(body, size),
            b'M' | b'Q' => judge_value(body.get(1..).unwrap_or_default(), size.saturating_sub(1)),
            b'L' => judge_text(body, size, 9),
            b'C' => judge_text(body, size, 11),
            b'O' | b'R' => sized(size == 2),
            b'B' => sized(size >= 40),
            _ => sized(size > 0 && kind.is_ascii_alphabetic()),
        }
    }

    fn judge_topic(&self, name: &[u8]) -> Trust {
        match std::str::from_utf8(name) {
            Ok(name) if self.definitions.formats.knows(name) => Trust::Words,
            Ok(name) if name.len() <= NAME && name.bytes().all(is_of_name) => Trust::Doubtful,
            _ => Trust::None,
        }
    }
}

/// Size and kind of a message; `None` where they are out of sight. A size of 0 is none.
#[inline]
fn header(bytes: &[u8]) -> Option<(usize, u8)> {
    let [low, high, kind] = *bytes.first_chunk()?;
    Some((usize::from(u16::from_le_bytes([low, high])), kind))
}

/// What the user guide allows in a topic's name.
fn is_of_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"_-/".contains(&byte)
}

/// `name:type …`
fn judge_format(body: &[u8], short: bool) -> Trust {
    let Some(colon) = body.iter().take(NAME + 1).position(|&byte| !is_of_name(byte)) else {
        return if short && body.len() <= NAME { Trust::Doubtful } else { Trust::None };
    };
    let type_name = body.get(colon + 1..).unwrap_or_default();
    if colon < 1 || body.get(colon) != Some(&b':') {
        Trust::None
    } else if colon > 2 && type_name.iter().take(3).filter(|&&b| is_of_name(b)).count() == 3 {
        Trust::Words
    } else {
        Trust::Doubtful
    }
}

/// A key, `type name`, preceded by its length, and a value; in `size` bytes.
fn judge_value(body: &[u8], size: usize) -> Trust {
    let Some((&key, rest)) = body.split_first() else {
        return if size > 0 { Trust::Doubtful } else { Trust::None };
    };
    let key = usize::from(key);
    if key >= size {
        return Trust::None;
    }
    let types: [&[u8]; 6] = [b"char", b"int", b"uint", b"float", b"bool", b"double"];
    let key = rest.get(..key).unwrap_or_default();
    let known = types.iter().any(|name| key.starts_with(name)) && key.contains(&b' ');
    if known && key.iter().all(|&b| b.is_ascii_graphic() || b == b' ') {
        Trust::Words
    } else {
        Trust::Doubtful
    }
}

/// A level and a text, which starts at `start`.
fn judge_text(body: &[u8], size: usize, start: usize) -> Trust {
    if size < start {
        return Trust::None;
    }
    let level = body.first().is_some_and(|level| (b'0'..=b'7').contains(level));
    let text = body.get(start..).unwrap_or_default();
    let printed = text.iter().take(32).all(|&b| b >= b' ' || b"\t\n\r\x1b".contains(&b));
    if level && text.len() >= 4 && printed { Trust::Words } else { Trust::Doubtful }
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::path::Path;

    use super::*;

    #[test]
    fn a_message_of_no_bytes_is_none_whatever_its_kind() {
        let input = Input::pipe(Path::new("a"), Box::new(io::empty()));
        let messages = Messages::new(input, Definitions::default());
        for kind in 0..=u8::MAX {
            let trust = messages.judge(&[&[0, 0, kind], &SYNC[..]].concat());
            assert_eq!(trust, Trust::None, "{}", char::from(kind));
        }
    }
}
