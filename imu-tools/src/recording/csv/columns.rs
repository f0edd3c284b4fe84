//! What stands in which column: told by the user, by the header's names, or by custom.

use std::str::FromStr;

use crate::recording::{ForceUnit, RateUnit, TimeUnit};

/// What separates fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// This byte, once.
    Byte(u8),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    /// The separator of a row of numbers.
    pub fn of(row: &[u8]) -> Self {
        let byte = [b';', b',', b'\t'].into_iter().find(|byte| row.contains(byte));
        byte.map_or(Self::Blanks, Self::Byte)
    }

    /// The fields of a line, without blanks and quotes around them.
    pub fn split(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let mut rest = Some(line);
        std::iter::from_fn(move || {
            let mut line = rest?;
            if self == Self::Blanks {
                line = line.trim_ascii_start();
                if line.is_empty() {
                    return None;
                }
            }
            let end = match self {
                Self::Byte(byte) => memchr::memchr(byte, line),
                Self::Blanks => memchr::memchr2(b' ', b'\t', line),
            };
            let field = line.get(..end.unwrap_or(line.len())).unwrap_or_default();
            rest = end.and_then(|end| line.get(end + 1..));
            Some(trim(field))
        })
    }
}

#[inline]
fn trim(field: &[u8]) -> &[u8] {
    let mut field = field.trim_ascii();
    if let [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] = field {
        field = inner.trim_ascii();
    }
    field
}

/// The meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Of no interest.
    Other,
    /// Time.
    Time,
    /// Angular rate about axis 0, 1, 2.
    Rate(u8),
    /// Specific force along axis 0, 1, 2.
    Force(u8),
}

/// What the names of columns say of their unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Told<U> {
    /// Nothing.
    #[default]
    Nothing,
    /// This unit.
    Unit(U),
    /// A unit that nobody knows, or two of them: what is wrong, in words.
    Unclear(String),
}

impl<U: FromStr<Err = String> + Copy + PartialEq> Told<U> {
    /// The unit given by the user, or else the one told.
    ///
    /// # Errors
    /// What is wrong with the one told, in words.
    pub fn unless(&self, given: Option<U>) -> Result<Option<U>, &str> {
        match (given, self) {
            (Some(given), _) => Ok(Some(given)),
            (None, Self::Nothing) => Ok(None),
            (None, Self::Unit(unit)) => Ok(Some(*unit)),
            (None, Self::Unclear(what)) => Err(what),
        }
    }

    /// Takes in what one column says; the first trouble stays.
    fn hear(&mut self, column: &[u8], unit: Option<&str>) {
        let unit = unit.unwrap_or_default().trim_matches(|c| "[]() ".contains(c));
        if unit.is_empty() || matches!(self, Self::Unclear(_)) {
            return;
        }
        let unclear =
            |what| Self::Unclear(format!("column '{}': {what}", String::from_utf8_lossy(column)));
        *self = match unit.parse() {
            Err(what) => unclear(what),
            Ok(unit) if matches!(self, Self::Unit(other) if *other != unit) => {
                unclear("its unit is not that of the sensor's other axes".into())
            }
            Ok(unit) => Self::Unit(unit),
        };
    }
}

/// Meanings of all columns, and the units that their names tell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// From the first to the last of interest.
    pub columns: Vec<Column>,
    /// Unit of time.
    pub time: Told<TimeUnit>,
    /// Unit of angular rate.
    pub rate: Told<RateUnit>,
    /// Unit of specific force.
    pub force: Told<ForceUnit>,
}

impl Columns {
    /// The order of tables without a header: t, gx, gy, gz, ax, ay, az.
    pub fn customary() -> Self {
        let axes = [0, 1, 2];
        let columns = [Column::Time].into_iter();
        let columns = columns.chain(axes.map(Column::Rate)).chain(axes.map(Column::Force));
        Self { columns: columns.collect(), ..Self::default() }
    }

    /// From a specification such as `t,gx,gy,gz,ax,ay,az,-`.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn from_spec(spec: &str) -> Result<Self, String> {
        let column = |name: &str| match name.trim() {
            "t" => Ok(Column::Time),
            "gx" => Ok(Column::Rate(0)),
            "gy" => Ok(Column::Rate(1)),
            "gz" => Ok(Column::Rate(2)),
            "ax" => Ok(Column::Force(0)),
            "ay" => Ok(Column::Force(1)),
            "az" => Ok(Column::Force(2)),
            "-" => Ok(Column::Other),
            name => Err(format!("'{name}' is none of t, gx, gy, gz, ax, ay, az and -")),
        };
        let columns = spec.split(',').map(column).collect::<Result<_, _>>()?;
        Self { columns, ..Self::default() }.checked()
    }

    /// From the names of a header.
    ///
    /// # Errors
    /// What is missing, in words.
    pub fn from_names<'a>(names: impl Iterator<Item = &'a [u8]>) -> Result<Self, String> {
        let mut found = Self::default();
        for text in names {
            let name = Name::new(text);
            let column = name.meaning();
            let unit = name.unit.as_deref();
            let taken = column != Column::Other && found.columns.contains(&column);
            match column {
                _ if taken => {}
                Column::Time => found.time.hear(text, unit),
                Column::Rate(_) => found.rate.hear(text, unit),
                Column::Force(_) => found.force.hear(text, unit),
                Column::Other => {}
            }
            found.columns.push(if taken { Column::Other } else { column });
        }
        found.checked()
    }

    /// Time once and at least one whole sensor.
    fn checked(mut self) -> Result<Self, String> {
        let count = |column: Column| self.columns.iter().filter(|&&c| c == column).count();
        let axes = |column: fn(u8) -> Column| [0, 1, 2].map(|axis| count(column(axis)));
        match (count(Column::Time), axes(Column::Rate), axes(Column::Force)) {
            (0, ..) => return Err("there is no column of time".into()),
            (1, [1, 1, 1], [1, 1, 1] | [0, 0, 0]) | (1, [0, 0, 0], [1, 1, 1]) => {}
            (1, [0, 0, 0], [0, 0, 0]) => {
                return Err("there is no column of a gyroscope or accelerometer".into());
            }
            _ => return Err("each sensor needs its x, y and z, each once".into()),
        }
        while self.columns.last() == Some(&Column::Other) {
            self.columns.pop();
        }
        Ok(self)
    }

    /// Whether these have the sensor of `column`.
    pub fn has(&self, column: Column) -> bool {
        self.columns.contains(&column)
    }
}

/// A column's name in parts.
struct Name {
    /// Words and single letters, in lower case.
    words: Vec<String>,
    unit: Option<String>,
}

/// Words that may precede an axis in one piece, as in `gyrox`.
const GYROSCOPE: [&str; 9] =
    ["gyro", "gyr", "gyroscope", "omega", "w", "g", "angularvelocity", "angvel", "rate"];
const ACCELEROMETER: [&str; 8] =
    ["accel", "acc", "accelerometer", "a", "linearacceleration", "acceleration", "linacc", "force"];

/// Words of columns that hold something else about a sensor.
const FOREIGN: [&str; 10] =
    ["covariance", "cov", "bias", "std", "sigma", "b", "ref", "mag", "orientation", "temp"];

impl Name {
    fn new(name: &[u8]) -> Self {
        let text = String::from_utf8_lossy(name);
        let text = text.trim().trim_start_matches('%');
        let (name, bracketed) = match text.find(['[', '(']) {
            Some(at) => {
                let (name, unit) = text.split_at(at);
                (name, Some(unit.trim_end().to_owned()))
            }
            None => (text, None),
        };
        let mut words: Vec<String> = name
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(str::to_lowercase)
            .collect();
        // A unit may also follow the name: time_ns, gyro_x_rad_s.
        let mut unit = bracketed;
        if unit.is_none() {
            let last = words.iter().rposition(|w| axis(w).is_some() || is_time(w)).map(|at| at + 1);
            if let Some(last) = last.filter(|&last| last < words.len()) {
                unit = Some(quotient(&words.split_off(last)));
            }
        }
        let mut name = Self { words, unit };
        if name.unit.is_none() {
            name.take_inner_unit();
        }
        name
    }

    /// Takes out a unit between sensor and axis: gyro_dps_x, acc_m_s2_x.
    fn take_inner_unit(&mut self) {
        let Some((axis, before)) = self.words.split_last() else { return };
        if !["x", "y", "z"].contains(&axis.as_str()) {
            return;
        }
        for at in 1..before.len() {
            let (sensor, unit) = before.split_at(at);
            let unit = quotient(unit);
            if named(sensor, &GYROSCOPE) && unit.parse::<RateUnit>().is_ok()
                || named(sensor, &ACCELEROMETER) && unit.parse::<ForceUnit>().is_ok()
            {
                self.words.drain(at..before.len());
                self.unit = Some(unit);
                return;
            }
        }
    }

    fn meaning(&self) -> Column {
        let word = |list: &[&str]| self.words.iter().any(|w| list.contains(&w.as_str()));
        if word(&FOREIGN) {
            return Column::Other;
        }
        let Some(last) = self.words.last() else { return Column::Other };
        if is_time(last) {
            return Column::Time;
        }
        let Some((stem, axis)) = axis(last) else { return Column::Other };
        let mut stems = self.words.clone();
        stems.pop();
        stems.push(stem.to_owned());
        match (named(&stems, &GYROSCOPE), named(&stems, &ACCELEROMETER)) {
            (true, false) => Column::Rate(axis),
            (false, true) => Column::Force(axis),
            _ => Column::Other,
        }
    }
}

/// Whether one of these words, or the last of them written as one, is of `list`.
fn named(words: &[String], list: &[&str]) -> bool {
    let one_piece = words.concat();
    let tail = list.iter().filter(|w| w.len() > 3).any(|w| one_piece.ends_with(w));
    tail || words.iter().any(|w| list.contains(&w.as_str()))
}

/// The unit that words of a name make up: `rad` and `s` are rad/s.
fn quotient(words: &[String]) -> String {
    match words {
        [over, under] if !under.starts_with(|c: char| c.is_ascii_digit()) => {
            format!("{over}/{under}")
        }
        words => words.concat(),
    }
}

fn is_time(word: &str) -> bool {
    ["t", "time", "timestamp", "timestamps", "stamp", "ts", "clock"].contains(&word)
}

/// The axis at the end of a word, and what stands before: `gyrox` is gyro and 0.
fn axis(word: &str) -> Option<(&str, u8)> {
    let stem = word.strip_suffix(['x', 'y', 'z'])?;
    let axis = word.bytes().last()?.checked_sub(b'x')?;
    let known = stem.is_empty() || GYROSCOPE.contains(&stem) || ACCELEROMETER.contains(&stem);
    known.then_some((stem, axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(header: &str) -> Result<Columns, String> {
        Columns::from_names(Separator::Byte(b',').split(header.as_bytes()))
    }

    fn told<U>(unit: Option<U>) -> Told<U> {
        unit.map_or(Told::Nothing, Told::Unit)
    }

    #[test]
    fn headers_that_people_write() {
        let (rate, force) = (Some(RateUnit::RadPerS), Some(ForceUnit::MPerS2));
        let customary = Columns::customary();
        for (header, time, rate, force) in [
            (
                "timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                 a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
                Some(TimeUnit::Nanoseconds),
                rate,
                force,
            ),
            (
                "timestamp [ns],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],\
                 accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]",
                Some(TimeUnit::Nanoseconds),
                rate,
                force,
            ),
            ("t,gx,gy,gz,ax,ay,az", None, None, None),
            ("Time,GyroX,GyroY,GyroZ,AccX,AccY,AccZ", None, None, None),
            (
                "time_us,omega_x (deg/s),omega_y (deg/s),omega_z (deg/s),acc_x (g),acc_y (g),acc_z (g)",
                Some(TimeUnit::Microseconds),
                Some(RateUnit::DegPerS),
                Some(ForceUnit::G),
            ),
            (
                "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2",
                Some(TimeUnit::Seconds),
                rate,
                force,
            ),
            (
                "time,angular_velocity.x,angular_velocity.y,angular_velocity.z,\
                 linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
                None,
                None,
                None,
            ),
            (
                "stamp (s),wx,wy,wz,acc_x [mg],acc_y [mg],acc_z [mg]",
                Some(TimeUnit::Seconds),
                None,
                Some(ForceUnit::MilliG),
            ),
            (
                "time_s,gyro_dps_x,gyro_dps_y,gyro_dps_z,acc_g_x,acc_g_y,acc_g_z",
                Some(TimeUnit::Seconds),
                Some(RateUnit::DegPerS),
                Some(ForceUnit::G),
            ),
            (
                "t,angular_velocity_rad_s_x,angular_velocity_rad_s_y,angular_velocity_rad_s_z,\
                 acc_m_s2_x,acc_m_s2_y,acc_m_s2_z",
                None,
                rate,
                force,
            ),
            (
                "t,gyro_x_deg_per_s,gyro_y_deg_per_s,gyro_z_deg_per_s,a_ms2_x,a_ms2_y,a_ms2_z",
                None,
                Some(RateUnit::DegPerS),
                force,
            ),
        ] {
            let (time, rate, force) = (told(time), told(rate), told(force));
            let expected = Columns { columns: customary.columns.clone(), time, rate, force };
            assert_eq!(named(header), Ok(expected), "{header}");
        }
    }

    #[test]
    fn units_that_nobody_knows_are_no_si_units() {
        let time = named("t [min],gx,gy,gz").unwrap().time;
        assert!(time.unless(None).unwrap_err().contains("'t [min]': 'min' is no unit of time"));
        assert_eq!(time.unless(Some(TimeUnit::Seconds)), Ok(Some(TimeUnit::Seconds)));
        let rate = named("t,gyro_x_rpm,gyro_y_rpm,gyro_z_rpm").unwrap().rate;
        assert!(rate.unless(None).unwrap_err().contains("'rpm' is no unit of angular rate"));
        let force = named("t,ax [g],ay [mg],az [g]").unwrap().force;
        assert!(force.unless(None).unwrap_err().contains("'ay [mg]': its unit is not that of"));
    }

    #[test]
    fn other_columns_are_left_alone() {
        let columns = named(
            "seq,%time,field.header.stamp,field.orientation.x,field.angular_velocity.x,\
             field.angular_velocity.y,field.angular_velocity.z,\
             field.angular_velocity_covariance0,field.linear_acceleration.x,\
             field.linear_acceleration.y,field.linear_acceleration.z,mag_x,b_w_RS_S_x,temp",
        )
        .unwrap();
        use Column::{Force, Other, Rate, Time};
        let expected = [
            Other,
            Time,
            Other,
            Other,
            Rate(0),
            Rate(1),
            Rate(2),
            Other,
            Force(0),
            Force(1),
            Force(2),
        ];
        assert_eq!(columns.columns, expected);
    }

    #[test]
    fn specifications() {
        assert_eq!(Columns::from_spec("t,gx,gy,gz,ax,ay,az,-"), Ok(Columns::customary()));
        assert!(Columns::from_spec("gx,gy,gz,ax,ay,az").unwrap_err().contains("time"));
        assert!(Columns::from_spec("t,gx,gy,ax,ay,az").is_err());
        assert!(Columns::from_spec("t,gx,gx,gz").is_err());
        assert!(Columns::from_spec("t,u").unwrap_err().contains("'u'"));
        assert!(Columns::from_spec("t,-,ax,ay,az").is_ok());
    }

    #[test]
    fn separators() {
        let fields = |line: &'static str| -> Vec<&[u8]> {
            Separator::of(line.as_bytes()).split(line.as_bytes()).collect()
        };
        assert_eq!(fields("1, 2 ,,3"), [&b"1"[..], b"2", b"", b"3"]);
        assert_eq!(fields("1;2"), [b"1", b"2"]);
        assert_eq!(fields("1\t2\t"), [&b"1"[..], b"2", b""]);
        assert_eq!(fields("  1   2 "), [b"1", b"2"]);
        assert_eq!(fields("\"1\",'2'"), [b"1", b"2"]);
    }
}
