//! The rows of a table, and the values in them.

use super::pages::Pages;
use super::{HEADER, half, word};
use crate::error::Error;

/// Page of the table of tables.
const SCHEMA: u32 = 1;

/// Kinds of pages in a table's tree.
const INNER: u8 = 5;
const LEAF: u8 = 13;

/// A tree of more levels would hold more pages than there are numbers for.
const DEEPEST: usize = 24;

/// A longer text or blob is none of ours: a message of an IMU has some hundred bytes.
const LONGEST: usize = 64 * 1024;

/// Values of a row that are brought together from their pages, at most: three texts of a topic.
const GATHERED: u64 = 4;

/// Values of a row that are looked at, at most.
const COLUMNS: usize = 64;

/// Where a value of a row is, and what it is.
#[derive(Clone, Copy, Debug)]
struct Field {
    kind: u64,
    /// Offset in the row.
    start: usize,
    len: usize,
}

/// A walk through the rows of a table, in the order of their numbers.
pub struct Rows {
    /// Pages to come, of each level of the tree.
    inner: Vec<std::vec::IntoIter<u32>>,
    /// The leaf whose rows come next.
    leaf: Vec<u8>,
    /// Offset of its own header.
    header: usize,
    cell: usize,
    cells: usize,
    /// Pages of the tree so far: in circles there would be no end.
    visited: u64,
    /// Overflow pages so far: each belongs to one row.
    followed: u64,
    /// Number of the row at hand.
    number: i64,
    /// Where in the leaf it starts, how much of it is there, and how long it is.
    start: usize,
    local: usize,
    len: usize,
    /// Where it goes on.
    overflow: u32,
    fields: Vec<Field>,
    gathered: Vec<u8>,
    /// Rows that are not what they should be.
    pub lost: u64,
}

impl Rows {
    /// The rows of the table whose tree begins in page `root`.
    pub fn new(root: u32) -> Self {
        Self {
            inner: vec![vec![root].into_iter()],
            leaf: Vec::new(),
            header: 0,
            cell: 0,
            cells: 0,
            visited: 0,
            followed: 0,
            number: 0,
            start: 0,
            local: 0,
            len: 0,
            overflow: 0,
            fields: Vec::new(),
            gathered: Vec::new(),
            lost: 0,
        }
    }

    /// The rows of the table of tables.
    pub fn of_schema() -> Self {
        Self::new(SCHEMA)
    }

    /// Goes to the next row; `false` at the end.
    pub fn advance(&mut self, pages: &mut Pages) -> Result<bool, Error> {
        loop {
            while self.cell < self.cells {
                self.cell += 1;
                if self.row(self.cell - 1, pages.usable).is_some() {
                    return Ok(true);
                }
                self.lost += 1;
            }
            if !self.next_leaf(pages)? {
                return Ok(false);
            }
        }
    }

    /// Goes to the next leaf.
    fn next_leaf(&mut self, pages: &mut Pages) -> Result<bool, Error> {
        (self.cell, self.cells) = (0, 0);
        while let Some(level) = self.inner.last_mut() {
            let Some(number) = level.next() else {
                self.inner.pop();
                continue;
            };
            self.visited += 1;
            if self.visited > pages.count {
                // Every page was seen, so this is one of them again.
                pages.lost += 1;
                self.inner.clear();
                return Ok(false);
            }
            let header = if number == SCHEMA { HEADER } else { 0 };
            let Some(page) = pages.page(number)? else {
                pages.lost += 1;
                continue;
            };
            let cells = half(page, header + 3).unwrap_or(0);
            match page.get(header) {
                Some(&LEAF) => {
                    self.leaf.clear();
                    self.leaf.extend_from_slice(page);
                    (self.header, self.cells) = (header, cells);
                    return Ok(true);
                }
                Some(&INNER) if self.inner.len() < DEEPEST => {
                    let child = |cell: usize| word(page, half(page, header + 12 + 2 * cell)?);
                    let mut children: Vec<u32> = (0..cells).map_while(child).collect();
                    let whole = children.len() == cells;
                    children.extend(word(page, header + 8));
                    if !whole {
                        pages.lost += 1;
                    }
                    self.inner.push(children.into_iter());
                }
                _ => pages.lost += 1,
            }
        }
        Ok(false)
    }

    /// Finds the values of a row of the leaf.
    fn row(&mut self, cell: usize, usable: usize) -> Option<()> {
        let start = half(&self.leaf, self.header + 8 + 2 * cell)?;
        let all = self.leaf.get(start..)?;
        let (len, rest) = varint(all)?;
        let (number, rest) = varint(rest)?;
        self.start = self.leaf.len() - rest.len();
        self.number = number.cast_signed();
        self.len = usize::try_from(len).ok()?;
        // How much of a row stays in its page, by section 1.6 of the source.
        let most = usable - 35;
        self.local = self.len;
        if self.len > most {
            let least = (usable - 12) * 32 / 255 - 23;
            let odd = least + (self.len - least) % (usable - 4);
            self.local = if odd <= most { odd } else { least };
        }
        let row = rest.get(..self.local)?;
        self.overflow = if self.local < self.len { word(rest, self.local)? } else { 0 };

        let (header, _) = varint(row)?;
        let header = usize::try_from(header).ok()?;
        let (_, mut kinds) = varint(row.get(..header)?)?;
        let mut at = header;
        self.fields.clear();
        while !kinds.is_empty() && self.fields.len() < COLUMNS {
            let (kind, rest) = varint(kinds)?;
            kinds = rest;
            let len = match kind {
                0 | 8 | 9 => 0,
                1..=4 => kind as usize,
                5 => 6,
                6 | 7 => 8,
                10 | 11 => return None,
                _ => usize::try_from((kind - 12) / 2).ok()?,
            };
            self.fields.push(Field { kind, start: at, len });
            at = at.checked_add(len)?;
        }
        (at <= self.len).then_some(())
    }

    /// The bytes of a value that are in the leaf; `None` if some are not.
    fn here(&self, field: Field) -> Option<&[u8]> {
        let row = self.leaf.get(self.start..self.start + self.local)?;
        row.get(field.start..field.start.checked_add(field.len)?)
    }

    /// A whole number of the row at hand; a column that is the row's number is stored as nothing.
    pub fn integer(&self, column: usize) -> Option<i64> {
        let field = *self.fields.get(column)?;
        match field.kind {
            0 => Some(self.number),
            8 => Some(0),
            9 => Some(1),
            1..=6 => {
                let bytes = self.here(field)?;
                let negative = bytes.first().is_some_and(|first| *first >= 0x80);
                let start = if negative { -1_i64 } else { 0 };
                Some(bytes.iter().fold(start, |value, byte| value << 8 | i64::from(*byte)))
            }
            _ => None,
        }
    }

    /// A text of the row at hand.
    pub fn text(&mut self, column: usize, pages: &mut Pages) -> Result<Option<String>, Error> {
        let bytes = self.bytes(column, pages)?;
        Ok(bytes.map(|bytes| String::from_utf8_lossy(bytes).into_owned()))
    }

    /// The bytes of a text or blob of the row at hand, brought together from where they are; `None`
    /// if they are not there, or too long to be one of ours.
    pub fn bytes(&mut self, column: usize, pages: &mut Pages) -> Result<Option<&[u8]>, Error> {
        let Some(field) = self.fields.get(column).copied().filter(|field| field.kind >= 12) else {
            return Ok(None);
        };
        let end = field.start + field.len;
        if end > self.local && (end > LONGEST || !self.gather(end, pages)?) {
            return Ok(None);
        }
        Ok(if end <= self.local { self.here(field) } else { self.gathered.get(field.start..end) })
    }

    /// Brings the row together up to `end`; `false` if its chain of pages breaks.
    fn gather(&mut self, end: usize, pages: &mut Pages) -> Result<bool, Error> {
        self.gathered.clear();
        let here = self.leaf.get(self.start..self.start + self.local);
        self.gathered.extend_from_slice(here.unwrap_or_default());
        let (mut next, usable) = (self.overflow, pages.usable);
        while self.gathered.len() < end {
            self.followed += 1;
            if self.followed > pages.count.saturating_mul(GATHERED) {
                return Ok(false);
            }
            let Some(page) = pages.page(next)? else { return Ok(false) };
            next = word(page, 0).unwrap_or(0);
            let left = end - self.gathered.len();
            let piece = page.get(4..usable).unwrap_or_default();
            self.gathered.extend_from_slice(piece.get(..left).unwrap_or(piece));
        }
        Ok(true)
    }
}

/// A number of one to nine bytes, seven bits each, and what follows it.
fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut value = 0_u64;
    for (at, &byte) in bytes.iter().enumerate().take(9) {
        if at == 8 {
            return Some((value << 8 | u64::from(byte), bytes.get(9..)?));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            return Some((value, bytes.get(at + 1..)?));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::MAGIC;
    use super::*;
    use crate::recording::input::Input;

    #[test]
    fn numbers_of_one_to_nine_bytes() {
        for (bytes, value) in
            [(&[0x7f][..], 127), (&[0x81, 0x00], 128), (&[0x82, 0x2c], 300), (&[0xff; 9], u64::MAX)]
        {
            assert_eq!(varint(bytes), Some((value, &[][..])));
            assert_eq!(varint(&bytes[..bytes.len() - 1]), None);
        }
    }

    /// A leaf whose rows are all the same one, of a blob on two pages that go on in each other.
    fn chains() -> Vec<u8> {
        const SIZE: usize = 512;
        let mut file = vec![0; 4 * SIZE];
        file[..MAGIC.len()].copy_from_slice(MAGIC);
        file[16..18].copy_from_slice(&(SIZE as u16).to_be_bytes());
        // 50000 bytes in the row and its number; its header: 5 bytes, one blob of 49995.
        let row = [0x83, 0x86, 0x50, 1, 5, 0x86, 0x8d, 0x22, 0];
        // What stays in the page by section 1.6 of the source, where (512 - 12)·32/255 - 23 is 39.
        let local = 39 + (50_000 - 39) % (SIZE - 4);
        let start = SIZE - (4 + local + 4);
        let cells = (start - 8) / 2;
        let leaf = &mut file[SIZE..2 * SIZE];
        leaf[0] = LEAF;
        leaf[3..5].copy_from_slice(&(cells as u16).to_be_bytes());
        for cell in 0..cells {
            leaf[8 + 2 * cell..10 + 2 * cell].copy_from_slice(&(start as u16).to_be_bytes());
        }
        leaf[start..start + row.len()].copy_from_slice(&row);
        leaf[SIZE - 1] = 3;
        file[2 * SIZE + 3] = 4;
        file[3 * SIZE + 3] = 3;
        file
    }

    #[test]
    fn chains_in_circles_end() {
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, &chains()).unwrap();
        let input = Input::file(Path::new("a"), file).unwrap();
        let mut pages = Pages::open(input, None).unwrap();
        let mut rows = Rows::new(2);
        let mut cells = 0;
        while rows.advance(&mut pages).unwrap() {
            assert_eq!(rows.len, 50_000);
            assert!(rows.bytes(0, &mut pages).unwrap().is_none());
            cells += 1;
        }
        assert!(cells > 10, "{cells}");
        assert!(pages.read <= 1 + GATHERED * pages.count, "{}", pages.read);
    }
}
