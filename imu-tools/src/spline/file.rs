//! Curves on disk: a CSV of control points under a few lines that say what they are.
//!
//! ```text
//! # imu spline 1: control points of a uniform cubic B-spline, which are no poses of the curve
//! # form: plain
//! # start_ns: 1403715273212140000
//! # step_ns: 50000000
//! # control_points: 2897
//! # end_ns: 1403715417962140000
//! c_x [m],c_y [m],c_z [m],c_qw [],c_qx [],c_qy [],c_qz []
//! 0.878847,2.1833333,…
//! ```
//!
//! Control point i belongs to start_ns + i·step_ns; the curve is known from the second one to `end_ns`, where the last
//! pose was. `form` says which curve of attitudes runs through them: `plain`, the cumulative product, or `symmetric`. Quaternions rotate
//! the body's axes to the world's, Hamilton, w first. Numbers are the shortest decimals that read back to the same
//! double, so a curve is read as it was written, bit for bit.

use std::io::{BufRead, BufReader, Read as _};
use std::path::Path;

use imu_core::Error as CoreError;
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::se3::Pose;
use imu_core::spline::Knots;

use super::{FEWEST_POSES, Fit, FormName, Given, Route};
use crate::error::Error;
use crate::output::Output;
use crate::recording::{self, poses::Poses};

/// What some programs put before a text.
const BOM: &[u8] = b"\xef\xbb\xbf";
/// What a file begins with.
const MAGIC: &str = "# imu spline ";
/// The version that is read and written.
const VERSION: &str = "1";
const COLUMNS: &str = "c_x [m],c_y [m],c_z [m],c_qw [],c_qx [],c_qy [],c_qz []";
/// Longer lines are none of such a file.
const LONGEST_LINE: u64 = 1000;
/// Text is handed on when there is so much of it.
const PIECE: usize = 256 * 1024;

/// The file of a fit, all written but not in its place yet.
///
/// # Errors
/// When it cannot be written.
pub fn write(path: &Path, fit: &Fit) -> Result<Output, Error> {
    let mut output = Output::create(path)?;
    let (name, knots) = (fit.form.name(), &fit.knots);
    let mut text = format!(
        "{MAGIC}{VERSION}: control points of a uniform cubic B-spline, which are no poses of the curve\n\
         # form: {name}\n# start_ns: {}\n# step_ns: {}\n# control_points: {}\n\
         # end_ns: {}\n{COLUMNS}\n",
        knots.start_ns(),
        knots.step_ns(),
        fit.control.len(),
        fit.span_ns.1,
    )
    .into_bytes();
    let mut digits = zmij::Buffer::new();
    for pose in fit.control.iter().copied().map(settled) {
        let (p, q) = (pose.translation(), pose.rotation());
        for (i, number) in p.iter().chain([&q.w, &q.i, &q.j, &q.k]).enumerate() {
            if i > 0 {
                text.push(b',');
            }
            text.extend_from_slice(digits.format(*number).as_bytes());
        }
        text.push(b'\n');
        if text.len() > PIECE {
            output.write(&text)?;
            text.clear();
        }
    }
    output.write(&text)?;
    Ok(output)
}

/// A file that was opened: a curve, or poses that make one.
pub(super) enum Opened {
    Curve(Route),
    Poses(Given),
}

/// Opens the file, or the pipe `-`, plain or compressed.
///
/// # Errors
/// When it cannot be read, with the line where there is one.
pub(super) fn open(path: &Path) -> Result<Opened, Error> {
    let name = if path == Path::new("-") { "the pipe".into() } else { path.display().to_string() };
    let mut input = recording::unpacked(path)?;
    input.fill(BOM.len() + MAGIC.len())?;
    if input.at_hand().starts_with(BOM) {
        input.consume(BOM.len());
    }
    if input.at_hand().starts_with(MAGIC.as_bytes()) {
        read(&name, BufReader::new(input)).map(Opened::Curve)
    } else {
        Given::of(name, Poses::of(input)?).map(Opened::Poses)
    }
}

/// The curve in the lines of a file; errors call it `name`.
///
/// # Errors
/// When they make no curve, with the line.
pub fn read(name: &str, lines: impl BufRead) -> Result<Route, Error> {
    let mut rows = Rows { name, lines, line: 0, text: String::new(), is_whole: true };
    rows.next()?;
    let version = rows.text.strip_prefix(MAGIC).and_then(|rest| rest.split(':').next());
    if version != Some(VERSION) {
        return Err(rows.wrong("a curve of another version; this program reads version 1"));
    }
    let form = rows.field("form")?.parse();
    let form: FormName = form.map_err(|known: String| rows.wrong(&known))?;
    let start_ns = rows.field("start_ns")?.parse();
    let start_ns: i64 = start_ns.map_err(|_| rows.wrong("start_ns is a whole number"))?;
    let step_ns = rows.field("step_ns")?.parse();
    let step_ns: u32 = step_ns.map_err(|_| rows.wrong("step_ns is a whole number below 2³²"))?;
    let count = rows.field("control_points")?.parse();
    let count: usize = count.map_err(|_| rows.wrong("control_points is a whole number"))?;
    let end_ns = rows.field("end_ns")?.parse();
    let end_ns: i64 = end_ns.map_err(|_| rows.wrong("end_ns is a whole number"))?;
    if !rows.next()? || rows.text != COLUMNS {
        return Err(rows.wrong(&format!("the columns are {COLUMNS}")));
    }
    let mut control = Vec::new();
    while rows.next()? {
        if rows.text.is_empty() {
            continue;
        }
        control.push(rows.pose().ok_or_else(|| rows.wrong("this is no control point"))?);
    }
    if !rows.is_whole || control.len() != count {
        return Err(Error::data(format!(
            "{name} is cut off or was changed: it holds {} of {count} control points",
            control.len()
        )));
    }
    let of_curve = |error: CoreError| {
        let why = match error {
            CoreError::OutOfRange("count") if count < FEWEST_POSES => {
                format!("there are {count}, and a curve needs {FEWEST_POSES} or more")
            }
            CoreError::OutOfRange("count") => "they end behind the last instant there is".into(),
            CoreError::OutOfRange("step_ns") => "step_ns is 0".into(),
            CoreError::OutOfRange("span_ns") => {
                format!("end_ns, {end_ns}, is not within their time")
            }
            _ => "two neighbours are half a turn apart".into(),
        };
        Error::data(format!("{name}: its control points make no curve: {why}"))
    };
    let knots = Knots::new(start_ns, step_ns, control.len()).map_err(of_curve)?;
    let span_ns = (knots.span().0, end_ns);
    Route::new(form, knots, span_ns, &control, Vec::new()).map_err(of_curve)
}

/// The lines of a file.
struct Rows<'a, R> {
    name: &'a str,
    lines: R,
    line: u64,
    text: String,
    /// The last line had its end.
    is_whole: bool,
}

impl<R: BufRead> Rows<'_, R> {
    /// The next line, without its end; `false` behind the last.
    fn next(&mut self) -> Result<bool, Error> {
        self.line += 1;
        let mut bytes = std::mem::take(&mut self.text).into_bytes();
        bytes.clear();
        let read = (&mut self.lines).take(LONGEST_LINE).read_until(b'\n', &mut bytes);
        let count = read.map_err(|source| Error::io("read", Path::new(self.name), source))?;
        self.text = String::from_utf8(bytes).map_err(|_| self.wrong("it is not text in UTF-8"))?;
        self.is_whole = count == 0 && self.is_whole || self.text.ends_with('\n');
        self.text.truncate(self.text.trim_end().len());
        Ok(count > 0)
    }

    fn wrong(&self, sentence: &str) -> Error {
        Error::data(format!("{}, line {}: {sentence}", self.name, self.line))
    }

    /// What the next line, `# KEY: VALUE`, says.
    fn field(&mut self, key: &str) -> Result<&str, Error> {
        self.next()?;
        let value = |text: &str| {
            text.strip_prefix("# ")?.strip_prefix(key)?.strip_prefix(':').map(|v| v.trim().len())
        };
        match value(&self.text) {
            Some(length) => Ok(self.text.split_at(self.text.len() - length).1),
            None => Err(self.wrong(&format!("here a curve has a line `# {key}: …`"))),
        }
    }

    /// A control point, its quaternion as it stands here.
    fn pose(&self) -> Option<Pose<f64>> {
        let mut numbers = [0.0; 7];
        let mut fields = self.text.split(',');
        for number in &mut numbers {
            *number = fields.next()?.trim().parse().ok()?;
        }
        let [x, y, z, w, i, j, k] = numbers;
        let whole = fields.next().is_none();
        Pose::new(Quaternion::new(w, i, j, k), Vector3::new(x, y, z)).ok().filter(|_| whole)
    }
}

/// A pose whose quaternion stays as it is when it is taken to unit length once more.
///
/// A division by a length that is 1 but for a rounding can change last bits to and fro; then the last bits of the
/// largest component are changed so that the length is 1 to the last bit.
pub(super) fn settled(pose: Pose<f64>) -> Pose<f64> {
    const MOST_STEPS: usize = 8;
    let here = <[f64; 4]>::from(pose.rotation().coords);
    let largest = |largest: usize, at: usize| {
        if here[at].abs() > here[largest].abs() { at } else { largest }
    };
    let at = (0..here.len()).fold(0, largest);
    let along = |step: fn(f64) -> f64| {
        let values = std::iter::successors(Some(here[at]), move |value| Some(step(*value)));
        values.take(MOST_STEPS)
    };
    let stays = |value: f64| {
        let mut there = here;
        there[at] = value;
        let [x, y, z, w] = there;
        let made = Pose::new(Quaternion::new(w, x, y, z), pose.translation()).ok()?;
        (<[f64; 4]>::from(made.rotation().coords) == there).then_some(made)
    };
    along(f64::next_up).chain(along(f64::next_down)).find_map(stays).unwrap_or(pose)
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
