//! SQLite files put together by hand: the tables of a rosbag2, as far as a reader needs them.

/// A value of a row.
#[derive(Clone, Debug)]
pub enum Value {
    /// What a column that is the row's number is stored as.
    Null,
    /// A whole number.
    Integer(i64),
    /// A text.
    Text(String),
    /// Bytes.
    Blob(Vec<u8>),
}

/// A number of one to nine bytes; only what fits eight bytes is needed.
#[must_use]
pub fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = vec![(value & 0x7f) as u8];
    value >>= 7;
    while value > 0 {
        bytes.insert(0, (value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes
}

/// A row: the types of its values, and the values.
#[must_use]
pub fn record(values: &[Value]) -> Vec<u8> {
    let (mut kinds, mut body) = (Vec::new(), Vec::new());
    for value in values {
        match value {
            Value::Null => kinds.extend(varint(0)),
            Value::Integer(v) => {
                kinds.extend(varint(6));
                body.extend(v.to_be_bytes());
            }
            Value::Text(text) => {
                kinds.extend(varint(13 + 2 * text.len() as u64));
                body.extend(text.as_bytes());
            }
            Value::Blob(bytes) => {
                kinds.extend(varint(12 + 2 * bytes.len() as u64));
                body.extend(bytes);
            }
        }
    }
    [varint(kinds.len() as u64 + 1), kinds, body].concat()
}

/// The file.
pub struct Database {
    page: usize,
    pages: Vec<Vec<u8>>,
}

impl Database {
    /// A file with pages of this size, of which the first is still empty.
    #[must_use]
    pub fn new(page: usize) -> Self {
        Self { page, pages: vec![Vec::new()] }
    }

    fn add(&mut self, page: Vec<u8>) -> u32 {
        self.pages.push(page);
        self.pages.len() as u32
    }

    /// A row as a leaf holds it; what does not fit goes on in pages of its own.
    fn cell(&mut self, number: u64, row: &[u8]) -> Vec<u8> {
        let mut cell = [varint(row.len() as u64), varint(number)].concat();
        let most = self.page - 35;
        if row.len() <= most {
            cell.extend(row);
            return cell;
        }
        let least = (self.page - 12) * 32 / 255 - 23;
        let odd = least + (row.len() - least) % (self.page - 4);
        let (here, rest) = row.split_at(if odd <= most { odd } else { least });
        let mut next = 0_u32;
        for piece in rest.chunks(self.page - 4).rev() {
            next = self.add([&next.to_be_bytes()[..], piece].concat());
        }
        cell.extend(here);
        cell.extend(next.to_be_bytes());
        cell
    }

    /// A page of these cells; the first page of a file keeps 100 bytes free.
    fn page(&self, kind: u8, before: usize, last: Option<u32>, cells: &[Vec<u8>]) -> Vec<u8> {
        let mut page = vec![0; self.page];
        let mut end = self.page;
        let head = before + if last.is_some() { 12 } else { 8 };
        page[before] = kind;
        page[before + 3..before + 5].copy_from_slice(&(cells.len() as u16).to_be_bytes());
        if let Some(last) = last {
            page[before + 8..before + 12].copy_from_slice(&last.to_be_bytes());
        }
        for (at, cell) in cells.iter().enumerate() {
            end -= cell.len();
            page[end..end + cell.len()].copy_from_slice(cell);
            page[head + 2 * at..head + 2 * at + 2].copy_from_slice(&(end as u16).to_be_bytes());
        }
        page
    }

    /// A table of these rows, numbered from 1; the page in which it begins.
    ///
    /// # Panics
    /// When the table has more leaves than one inner page can name.
    pub fn table(&mut self, rows: &[Vec<Value>]) -> u32 {
        let mut leaves = Vec::new();
        let (mut cells, mut room) = (Vec::new(), self.page - 8);
        for (number, row) in (1..).zip(rows) {
            let cell = self.cell(number, &record(row));
            if cell.len() + 2 > room {
                let page = self.page(13, 0, None, &cells);
                leaves.push((self.add(page), number - 1));
                (cells, room) = (Vec::new(), self.page - 8);
            }
            room -= cell.len() + 2;
            cells.push(cell);
        }
        let page = self.page(13, 0, None, &cells);
        let last = self.add(page);
        if leaves.is_empty() {
            return last;
        }
        let inner: Vec<Vec<u8>> = leaves
            .iter()
            .map(|(page, key)| [&page.to_be_bytes()[..], &varint(*key)].concat())
            .collect();
        let page = self.page(5, 0, Some(last), &inner);
        self.add(page)
    }

    /// The whole file; `tables` are names, first pages and the commands that made them.
    #[must_use]
    pub fn finish(mut self, tables: &[(&str, u32, &str)]) -> Vec<u8> {
        let rows: Vec<Vec<u8>> = (1..)
            .zip(tables)
            .map(|(number, (name, root, sql))| {
                let text = |text: &str| Value::Text(text.to_owned());
                let root = Value::Integer((*root).into());
                let row = record(&[text("table"), text(name), text(name), root, text(sql)]);
                [varint(row.len() as u64), varint(number), row].concat()
            })
            .collect();
        let mut first = self.page(13, 100, None, &rows);
        first[..16].copy_from_slice(b"SQLite format 3\0");
        let size = if self.page == 65_536 { 1 } else { self.page as u16 };
        first[16..18].copy_from_slice(&size.to_be_bytes());
        first[18..24].copy_from_slice(&[1, 1, 0, 64, 32, 32]);
        first[28..32].copy_from_slice(&(self.pages.len() as u32).to_be_bytes());
        first[56..60].copy_from_slice(&1_u32.to_be_bytes());
        self.pages[0] = first;
        for page in &mut self.pages {
            page.resize(self.page, 0);
        }
        self.pages.concat()
    }
}

/// A rosbag2's file: topics (number, name, type), and messages (topic, time, payload).
#[must_use]
pub fn rosbag2(
    page: usize,
    topics: &[(i64, &str, &str)],
    messages: &[(i64, i64, Vec<u8>)],
) -> Vec<u8> {
    let mut database = Database::new(page);
    let text = |text: &str| Value::Text(text.to_owned());
    let topics: Vec<Vec<Value>> = topics
        .iter()
        .map(|(id, name, kind)| {
            // The number stands in its column here, and is the row's own for messages.
            vec![Value::Integer(*id), text(name), text(kind), text("cdr"), text("")]
        })
        .collect();
    let topics = database.table(&topics);
    let messages: Vec<Vec<Value>> = messages
        .iter()
        .map(|(topic, time, payload)| {
            let (topic, time) = (Value::Integer(*topic), Value::Integer(*time));
            vec![Value::Null, topic, time, Value::Blob(payload.clone())]
        })
        .collect();
    let messages = database.table(&messages);
    database.finish(&[
        (
            "topics",
            topics,
            "CREATE TABLE topics(id INTEGER,name TEXT,type TEXT,serialization_format TEXT,q TEXT)",
        ),
        (
            "messages",
            messages,
            "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,timestamp INTEGER,data BLOB)",
        ),
    ])
}
