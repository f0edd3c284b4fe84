//! The table of ceilings: what each figure may be.
//!
//! `target,case,figure,unit,ceiling,limit`. A ceiling is what was measured when the table was
//! blessed, and a little more, because another version of the compiler may do a little worse. A
//! limit is what must never be exceeded, whoever blesses: a number, or `= case: figure`, another
//! figure of the same target.

use crate::Result;
use std::fmt::Write as _;
use std::path::Path;

/// Above what is measured, in a ceiling: 2 %. A size of a value is exact and has none.
const HEADROOM: f64 = 1.02;
/// A figure below this part of its ceiling is worth a note.
const BETTER: f64 = 0.95;
/// Two figures are equal within SysTick's resolution over the calls that they average.
const EQUAL: f64 = 1.0;

/// Something measured.
pub struct Figure {
    /// The processor.
    pub target: String,
    /// The case, or the image, in which it was measured.
    pub case: String,
    /// What was measured.
    pub what: String,
    /// Instructions or bytes.
    pub unit: String,
    /// The figure itself.
    pub value: f64,
}

struct Row {
    key: String,
    ceiling: f64,
    limit: String,
}

impl Figure {
    fn key(&self) -> String {
        format!("{},{},{},{}", self.target, self.case, self.what, self.unit)
    }

    /// What `--bless` makes the ceiling: instructions to a tenth, bytes to a whole.
    fn ceiling(&self) -> f64 {
        match (self.unit.as_str(), self.what.ends_with("state")) {
            (_, true) => self.value,
            ("instructions", _) => (self.value * HEADROOM * 10.0).ceil() / 10.0,
            _ => (self.value * HEADROOM).ceil(),
        }
    }
}

/// Prints every figure beside its ceiling, or writes a new table; true if nothing is exceeded.
pub fn check(path: &Path, figures: &[Figure], compiler: &str, bless: bool) -> Result<bool> {
    let (counted_with, rows) = read(path)?;
    let mut good = true;
    for figure in figures {
        let row = rows.iter().find(|row| row.key == figure.key());
        let verdict = verdict(figure, row, figures, bless);
        good &= verdict.is_ok();
        println!(
            "{:4} {:50} {:>11.1} {:12} {}",
            figure.target,
            format!("{}: {}", figure.case, figure.what),
            figure.value,
            figure.unit,
            verdict.unwrap_or_else(|complaint| complaint)
        );
    }
    if bless {
        write(path, figures, &rows, compiler)?;
        println!("{} written", path.display());
        return Ok(good);
    }
    for row in rows.iter().filter(|row| figures.iter().all(|figure| figure.key() != row.key)) {
        println!("GONE: {} is in the table and was not measured: --bless removes it", row.key);
        good = false;
    }
    if !good && counted_with != compiler {
        println!("The ceilings were counted with {counted_with}; this is {compiler}.");
    }
    Ok(good)
}

fn verdict(
    figure: &Figure,
    row: Option<&Row>,
    figures: &[Figure],
    bless: bool,
) -> std::result::Result<String, String> {
    let Some(row) = row else {
        return if bless { Ok("new".into()) } else { Err("NO CEILING: add it by --bless".into()) };
    };
    if let Some(other) = row.limit.strip_prefix("= ") {
        let same =
            |f: &&Figure| f.target == figure.target && format!("{}: {}", f.case, f.what) == other;
        match figures.iter().find(same) {
            None => return Err(format!("NO SUCH FIGURE as its limit, `{other}`")),
            Some(other) if figure.value > other.value + EQUAL => {
                return Err(format!("EXCEEDS {}: {}, {:.1}", other.case, other.what, other.value));
            }
            Some(_) => {}
        }
    } else if let Ok(limit) = row.limit.parse::<f64>()
        && figure.value > limit
    {
        return Err(format!("EXCEEDS the limit {limit}"));
    }
    if bless {
        Ok(format!("was {}", row.ceiling))
    } else if figure.value > row.ceiling {
        Err(format!("EXCEEDS the ceiling {}", row.ceiling))
    } else if figure.value < BETTER * row.ceiling {
        let better = 100.0 * (1.0 - figure.value / row.ceiling);
        Ok(format!("of {}: {better:.0} % better, lower the ceiling by --bless", row.ceiling))
    } else {
        Ok(format!("of {}", row.ceiling))
    }
}

/// The compiler that the table was counted with, and its rows; none if there is no table.
fn read(path: &Path) -> Result<(String, Vec<Row>)> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(format!("{}: {e}", path.display())),
    };
    let mut compiler = String::new();
    let mut rows = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if let Some(name) = line.strip_prefix("# Counted with ") {
            compiler = name.trim_end_matches('.').into();
        }
        if line.starts_with('#') || line.starts_with("target,") {
            continue;
        }
        let row = || {
            let (rest, limit) = line.rsplit_once(',')?;
            let (key, ceiling) = rest.rsplit_once(',')?;
            Some(Row { key: key.into(), ceiling: ceiling.parse().ok()?, limit: limit.into() })
        };
        rows.push(row().ok_or_else(|| format!("{}:{}: {line}", path.display(), number + 1))?);
    }
    Ok((compiler, rows))
}

fn write(path: &Path, figures: &[Figure], rows: &[Row], compiler: &str) -> Result<()> {
    let mut text = format!(
        "# Written by `tests/firmware/run --bless`: what was measured and 2 % more. The last column \
         is\n# kept: a limit from the specification, or `= case: figure` not to be exceeded.\n\
         # Counted with {compiler}.\ntarget,case,figure,unit,ceiling,limit\n"
    );
    for figure in figures {
        let key = figure.key();
        let limit = rows.iter().find(|row| row.key == key).map_or("", |row| &row.limit);
        let _ = writeln!(text, "{key},{},{limit}", figure.ceiling());
    }
    let partial = path.with_extension("csv.partial");
    std::fs::write(&partial, text)
        .and_then(|()| std::fs::rename(&partial, path))
        .map_err(|e| format!("{}: {e}", path.display()))
}
