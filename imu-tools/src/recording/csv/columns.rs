//! What stands in which column: told by the user, by the header's names, or by custom.

use super::celsius::Celsius;
use super::increments;
use super::names::Name;
use super::told::Told;
use crate::recording::sensor::Sensor;
use crate::recording::{ForceUnit, RateUnit, TimeUnit};

/// The meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Of no interest.
    Other,
    /// Time, in a unit or as a date.
    Time,
    /// The whole seconds of a time in two columns.
    Seconds,
    /// The nanoseconds of a time in two columns.
    Nanoseconds,
    /// The day of a time that is a time of day.
    Date,
    /// Angular rate about axis 0, 1, 2.
    Rate(u8),
    /// Specific force along axis 0, 1, 2.
    Force(u8),
    /// Temperature.
    Temperature,
}

/// Meanings of all columns, and the units that their names tell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// From the first to the last of interest.
    pub columns: Vec<Column>,
    /// Unit of time.
    pub time: Told<TimeUnit>,
    /// Unit of angular rate.
    pub rate: Told<RateUnit>,
    /// Unit of specific force.
    pub force: Told<ForceUnit>,
    /// Scale of temperature.
    pub celsius: Celsius,
    /// In the place of angular rates stand increments of angle, in this unit times a second.
    pub angles: bool,
    /// In the place of specific forces stand increments of velocity, in this unit times a second.
    pub velocities: bool,
}

/// The column that a user calls by this key.
fn by_key(key: &str) -> Option<Column> {
    Some(match key.trim() {
        "t" => Column::Time,
        "sec" => Column::Seconds,
        "nsec" => Column::Nanoseconds,
        "date" => Column::Date,
        "gx" => Column::Rate(0),
        "gy" => Column::Rate(1),
        "gz" => Column::Rate(2),
        "ax" => Column::Force(0),
        "ay" => Column::Force(1),
        "az" => Column::Force(2),
        "temp" => Column::Temperature,
        _ => return None,
    })
}

const KEYS: &str = "t, sec, nsec, date, gx, gy, gz, ax, ay, az, temp";

impl Columns {
    /// The order of tables without a header: t, gx, gy, gz, ax, ay, az.
    pub fn customary() -> Self {
        let axes = [0, 1, 2];
        let columns = [Column::Time].into_iter();
        let columns = columns.chain(axes.map(Column::Rate)).chain(axes.map(Column::Force));
        Self { columns: columns.collect(), ..Self::default() }
    }

    /// The 40 columns of `ros2 topic echo --csv` for a sensor_msgs/msg/Imu, which has no header:
    /// stamp, frame, orientation, three vectors, each followed by nine of its covariance.
    pub fn of_ros2_echo() -> Self {
        let mut columns = vec![Column::Other; 37];
        let places = [
            (0, Column::Seconds),
            (1, Column::Nanoseconds),
            (16, Column::Rate(0)),
            (17, Column::Rate(1)),
            (18, Column::Rate(2)),
            (28, Column::Force(0)),
            (29, Column::Force(1)),
            (30, Column::Force(2)),
        ];
        for (at, column) in places {
            if let Some(place) = columns.get_mut(at) {
                *place = column;
            }
        }
        columns.truncate(31);
        Self {
            columns,
            rate: Told::Unit(RateUnit::RadPerS),
            force: Told::Unit(ForceUnit::MPerS2),
            ..Self::default()
        }
    }

    /// From a specification such as `t,gx,gy,gz,ax,ay,az,-`.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn from_spec(spec: &str) -> Result<Self, String> {
        Self::of_spec(spec)?.checked()
    }

    /// The same of lines that come live, and need no time.
    ///
    /// # Errors
    /// As [`Self::from_spec`].
    pub fn live_from_spec(spec: &str) -> Result<Self, String> {
        Self::of_spec(spec)?.checked_sensors()
    }

    fn of_spec(spec: &str) -> Result<Self, String> {
        let column = |key: &str| match key.trim() {
            "-" => Ok(Column::Other),
            key => by_key(key).ok_or_else(|| format!("'{key}' is none of {KEYS} and -")),
        };
        let columns = spec.split(',').map(column).collect::<Result<_, _>>()?;
        Ok(Self { columns, ..Self::default() })
    }

    /// From names of columns that the user gives, such as `t=stamp,gx=omega.x`.
    ///
    /// # Errors
    /// What is wrong with them, in words: with a name that is not there, those that are.
    pub fn from_map(map: &str, names: &[&[u8]]) -> Result<Self, String> {
        let texts: Vec<String> =
            names.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        let mut found = Self { columns: vec![Column::Other; names.len()], ..Self::default() };
        for pair in map.split(',') {
            let (key, wanted) = pair
                .split_once('=')
                .ok_or_else(|| format!("'{pair}' is no pair such as gx=omega.x"))?;
            let column = by_key(key).ok_or_else(|| format!("'{key}' is none of {KEYS}"))?;
            let wanted = wanted.trim();
            let bare = |text: &str| {
                text.split(['[', '(']).next().unwrap_or(text).trim().eq_ignore_ascii_case(wanted)
            };
            let at = texts
                .iter()
                .position(|text| text == wanted)
                .or_else(|| texts.iter().position(|text| text.eq_ignore_ascii_case(wanted)))
                .or_else(|| texts.iter().position(|text| bare(text)));
            let Some(at) = at else {
                return Err(format!("there is no column '{wanted}', only {}", listed(&texts)));
            };
            match found.columns.get_mut(at) {
                Some(place @ Column::Other) => *place = column,
                _ => return Err(format!("column '{wanted}' is given twice")),
            }
            let text = names.get(at).copied().unwrap_or_default();
            found.hear_name(column, text, &Name::new(text));
        }
        found.checked()
    }

    /// From the names of a header; axes without a sensor are those of `hint`, where the whole table is
    /// of one sensor.
    ///
    /// # Errors
    /// What is missing, in words.
    pub fn from_names(names: &[&[u8]], hint: Option<Sensor>) -> Result<Self, String> {
        Self::of_names(names, hint).checked()
    }

    /// The same of lines that come live, and need no time.
    ///
    /// # Errors
    /// As [`Self::from_names`].
    pub fn live_from_names(names: &[&[u8]]) -> Result<Self, String> {
        Self::of_names(names, None).checked_sensors()
    }

    fn of_names(names: &[&[u8]], hint: Option<Sensor>) -> Self {
        let parts: Vec<Name> = names.iter().map(|text| Name::new(text)).collect();
        let mut found = Self::default();
        let time = time_among(&parts);
        let meanings = increments::meanings(&parts, hint).into_iter();
        for (at, ((text, name), column)) in names.iter().zip(&parts).zip(meanings).enumerate() {
            let mut column = match column {
                Column::Time => Column::Other,
                column => column,
            };
            if let Some(&(_, part)) = time.iter().find(|(place, _)| *place == at) {
                column = part;
            }
            if column != Column::Other && found.columns.contains(&column) {
                column = Column::Other;
            }
            if column == Column::Temperature && Celsius::of(name.unit.as_deref()).is_none() {
                column = Column::Other;
            }
            found.hear_name(column, text, name);
            found.columns.push(column);
        }
        found
    }

    /// Takes in whether a column's name, `text`, tells of increments, and its unit.
    fn hear_name(&mut self, column: Column, text: &[u8], name: &Name) {
        match column {
            Column::Rate(_) => self.angles |= name.is_increment(),
            Column::Force(_) => self.velocities |= name.is_increment(),
            _ => {}
        }
        self.hear(column, text, name.unit.as_deref());
    }

    /// The unit of angular rate that these words are, or of angle where there are increments.
    fn rate_unit(&self) -> fn(&str) -> Result<RateUnit, String> {
        if self.angles { RateUnit::of_increment } else { str::parse }
    }

    /// The unit of specific force that these words are, or of velocity where there are increments.
    fn force_unit(&self) -> fn(&str) -> Result<ForceUnit, String> {
        if self.velocities { ForceUnit::of_increment } else { str::parse }
    }

    /// Takes in the unit that a column's name tells.
    fn hear(&mut self, column: Column, name: &[u8], unit: Option<&str>) {
        match column {
            Column::Time => self.time.hear(name, unit, str::parse),
            Column::Rate(_) => self.rate.hear(name, unit, self.rate_unit()),
            Column::Force(_) => self.force.hear(name, unit, self.force_unit()),
            Column::Temperature => self.celsius = Celsius::of(unit).unwrap_or_default(),
            Column::Seconds | Column::Nanoseconds | Column::Date | Column::Other => {}
        }
    }

    /// Takes in a row of units; `false`, and nothing happens, when it is none.
    pub fn hear_units(&mut self, row: &[&[u8]]) -> bool {
        let texts: Vec<_> = row.iter().map(|field| String::from_utf8_lossy(field)).collect();
        let bare = |text: &str| text.trim_matches(|c| "[]() ".contains(c)).to_owned();
        let columns = self.columns.clone();
        let pairs = || columns.iter().zip(&texts);
        let known = pairs().filter(|(column, text)| match column {
            Column::Time => bare(text).parse::<TimeUnit>().is_ok(),
            Column::Rate(_) => self.rate_unit()(&bare(text)).is_ok(),
            Column::Force(_) => self.force_unit()(&bare(text)).is_ok(),
            _ => false,
        });
        if known.count() < 3 {
            return false;
        }
        for (column, text) in pairs() {
            self.hear(*column, text.as_bytes(), Some(text));
        }
        true
    }

    /// Time once and at least one whole sensor.
    fn checked(self) -> Result<Self, String> {
        let count = |column: Column| self.columns.iter().filter(|&&c| c == column).count();
        let time = [Column::Time, Column::Date, Column::Seconds, Column::Nanoseconds].map(count);
        match time {
            [0, _, 0, 0] => return Err("there is no column of time".into()),
            [1, 0 | 1, 0, 0] | [0, 0, 1, 1] => {}
            _ => return Err("time needs one column, or sec and nsec, or date and t".into()),
        }
        self.checked_sensors()
    }

    /// At least one whole sensor.
    fn checked_sensors(mut self) -> Result<Self, String> {
        let count = |column: Column| self.columns.iter().filter(|&&c| c == column).count();
        let axes = |column: fn(u8) -> Column| [0, 1, 2].map(|axis| count(column(axis)));
        match (axes(Column::Rate), axes(Column::Force)) {
            ([1, 1, 1], [1, 1, 1] | [0, 0, 0]) | ([0, 0, 0], [1, 1, 1]) => {}
            ([0, 0, 0], [0, 0, 0]) => {
                return Err("there is no column of a gyroscope or accelerometer".into());
            }
            _ => return Err("each sensor needs its x, y and z, each once".into()),
        }
        if count(Column::Temperature) > 1 {
            return Err("there can be one temperature".into());
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

/// The columns that make up the time: two halves, or a day and a time of day, or the message's own
/// stamp, or else the first.
fn time_among(names: &[Name]) -> Vec<(usize, Column)> {
    let half = |half: Column| names.iter().position(|name| name.half() == Some(half));
    if let (Some(seconds), Some(nanoseconds)) = (half(Column::Seconds), half(Column::Nanoseconds)) {
        return vec![(seconds, Column::Seconds), (nanoseconds, Column::Nanoseconds)];
    }
    let times = || names.iter().enumerate().filter(|(_, name)| name.meaning(None) == Column::Time);
    let date = times().find(|(_, name)| name.is_date());
    let best = times()
        .find(|(_, name)| name.is_header_stamp())
        .or_else(|| times().find(|(_, name)| !name.is_date()));
    match (date, best) {
        (Some((date, _)), Some((clock, _))) => {
            vec![(date, Column::Date), (clock, Column::Time)]
        }
        (Some((only, _)), None) | (None, Some((only, _))) => vec![(only, Column::Time)],
        (None, None) => Vec::new(),
    }
}

/// Names for an error, not too many of them.
fn listed(names: &[String]) -> String {
    const MOST: usize = 40;
    let shown: Vec<&str> =
        names.iter().take(MOST).map(String::as_str).filter(|name| !name.is_empty()).collect();
    let more = names.len().saturating_sub(MOST);
    match more {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}
