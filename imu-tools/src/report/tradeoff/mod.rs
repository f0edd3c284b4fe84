//! What accuracy costs, as tables on a terminal, as JSON, and as a section of a page.

pub mod allan;
pub mod rules;
pub mod spline;

use std::fmt::Write as _;

/// Three digits at most.
fn number(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        v if (1e-2..1000.0).contains(&v.abs()) => {
            let digits = (1.0 - v.abs().log10().floor()).max(0.0) as usize;
            format!("{v:.digits$}")
        }
        v => format!("{v:.1e}"),
    }
}

fn cells(names: &[&str], numbers: impl Iterator<Item = String>) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).chain(numbers).collect()
}

/// A title, and rows of cells, of which the first names the columns.
struct Table {
    title: String,
    /// So many columns from the left are names; the others are numbers.
    names: usize,
    rows: Vec<Vec<String>>,
}

/// Tables in columns of even width.
fn terminal(tables: &[Table]) -> String {
    let mut text = String::new();
    for Table { title, names, rows } in tables {
        let columns = rows.first().map_or(0, Vec::len);
        let width = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let _ = write!(text, "\n{title}\n");
        for row in rows {
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                // Words to the left, numbers to the right.
                let _ = match column < *names {
                    true => write!(text, "{cell:<width$}  "),
                    false => write!(text, "{cell:>width$}  "),
                };
            }
            text.truncate(text.trim_end().len());
            text.push('\n');
        }
    }
    text
}

/// Tables of a page.
fn markdown(tables: &[Table]) -> String {
    let mut text = String::new();
    for Table { title, names, rows } in tables {
        let _ = write!(text, "### {title}\n\n");
        for (k, row) in rows.iter().enumerate() {
            let _ = writeln!(text, "| {} |", row.join(" | "));
            if k == 0 {
                let rule = (0..row.len()).map(|k| if k < *names { "---" } else { "---:" });
                let _ = writeln!(text, "| {} |", rule.collect::<Vec<_>>().join(" | "));
            }
        }
        text.push('\n');
    }
    text
}

/// A page with a section in the place of the one with the same mark, or behind all others.
fn with_section(before: Option<&str>, mark: &str, section: &str) -> String {
    const TITLE: &str = "# What accuracy costs\n\nMeasured by `imu tradeoff`; run it to see your own \
                         machine.\n";
    let begin = format!("<!-- begin: imu tradeoff {mark} -->");
    let end = format!("<!-- end: imu tradeoff {mark} -->");
    let section = format!("{begin}\n{section}\n{end}");
    let before = before.unwrap_or(TITLE);
    // The first beginning whose end comes before another begins.
    let whole = before.match_indices(&begin).find_map(|(at, _)| {
        let (head, rest) = before.split_at(at);
        let inside = rest.get(begin.len()..)?;
        let next = inside.find(&begin).unwrap_or(inside.len());
        let past = inside.get(..next)?.find(&end)? + end.len();
        Some((head, inside.get(past..)?))
    });
    match whole {
        Some((head, tail)) => format!("{head}{section}{tail}"),
        None => format!("{}\n\n{section}\n", before.trim_end()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_takes_the_place_of_itself_and_of_nothing_else() {
        let page = |before: Option<&str>, text: &str| with_section(before, "this", text);
        let first = page(None, "one");
        assert!(first.starts_with("# What accuracy costs") && first.contains("one"));
        assert_eq!(page(Some(&first), "one"), first);
        assert_eq!(page(Some(&page(Some(&first), "two")), "one"), first);
        let other = with_section(Some(&first), "that", "three");
        assert!(other.contains("one") && other.contains("three"));
        assert_eq!(page(Some(&other), "one"), other);
        let mine = "# Mine\n\nSome words.\n";
        let with = page(Some(mine), "one");
        assert!(with.starts_with(mine));
        let more = format!("{with}\nMore.\n");
        assert_eq!(page(Some(&more), "one"), more);
        // A beginning without an end takes nothing with it, however often.
        let broken = "# Mine\n<!-- begin: imu tradeoff this -->\nKept.\n";
        let once = page(Some(broken), "one");
        assert!(once.starts_with(broken));
        assert_eq!(page(Some(&once), "one"), once);
    }

    #[test]
    fn numbers_have_two_digits_or_three() {
        let all = [0.0, 1.2345e-5, 0.0123, 0.123, 1.234, 12.34, 123.4, 12345.0].map(number);
        assert_eq!(all, ["0", "1.2e-5", "0.012", "0.12", "1.2", "12", "123", "1.2e4"]);
    }
}
