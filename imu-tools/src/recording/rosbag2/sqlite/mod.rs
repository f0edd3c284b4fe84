//! Reading the tables of an SQLite file: pages, B-trees and records, nothing of SQL but the names of
//! columns.
//!
//! A file is pages of one size; the first 100 bytes say which. A table is a tree of pages: inner
//! ones (kind 5) hold numbers of pages, leaves (kind 13) hold rows. A row is a header of types and
//! the values; what does not fit its page goes on in a chain of overflow pages. Table
//! `sqlite_schema`, in page 1, names the first page of every other one. What was committed but not
//! yet moved into the file stands in the write-ahead log. `pages` finds the newest state of each
//! page, `wal` those in the log, `rows` walks a table. Source: "Database File Format",
//! <https://www.sqlite.org/fileformat2.html>.
//!
//! A page that is not what it should be costs its rows, and is counted. Memory: a page and the
//! numbers in the inner pages above it.

mod pages;
mod rows;
mod wal;

pub use pages::Pages;
pub use rows::Rows;

/// The first bytes of every file.
pub const MAGIC: &[u8] = b"SQLite format 3\0";

/// Bytes of the file's header, in front of the first page's own.
const HEADER: usize = 100;

/// A number of four bytes, big-endian as all of them.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A number of two bytes.
fn half(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?)))
}

/// The names of a table's columns, from the command that made it.
pub fn columns(sql: &str) -> Vec<String> {
    let inside = sql.split_once('(').map_or("", |(_, rest)| rest);
    let inside = inside.rsplit_once(')').map_or(inside, |(inside, _)| inside);
    let mut depth = 0_usize;
    let parts = inside.split(|c| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth == 0
    });
    let quote = |c: char| "\"'`[]".contains(c);
    parts
        .filter_map(|part| part.split_whitespace().next())
        .map(|name| name.trim_matches(quote).to_lowercase())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_in_order() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,\
                   \"timestamp\" INTEGER DEFAULT (max(1, 2)), data BLOB NOT NULL)";
        assert_eq!(columns(sql), ["id", "topic_id", "timestamp", "data"]);
        assert_eq!(columns("CREATE"), Vec::<String>::new());
        assert_eq!(columns(")("), Vec::<String>::new());
    }
}
