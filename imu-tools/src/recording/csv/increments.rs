//! Increments of angle and velocity in a table, Δθ and Δv, read as means over their intervals.
//!
//! The increment of a row was gathered since the row before it, so that its mean is itself over the
//! time between their stamps. Where that time is not within half of the usual one (the median of the
//! first block), rows are lost or stamps repeat, and the usual one is what the increment took: it
//! covers its own interval, not the gap. The first row has none before it and gets the usual one too.

use super::columns::{Column, Columns};
use super::names::Name;
use crate::error::Error;
use crate::recording::sensor::Sensor;
use crate::recording::{Block, Note, Sample};

/// Names of increments, in one piece.
const ANGLES: [&str; 10] = [
    "deltaangle",
    "deltatheta",
    "deltaang",
    "dangle",
    "dtheta",
    "dang",
    "angleincrement",
    "angincrement",
    "angleinc",
    "anginc",
];
const VELOCITIES: [&str; 10] = [
    "deltavelocity",
    "deltavel",
    "deltav",
    "dvelocity",
    "dvel",
    "dv",
    "velocityincrement",
    "velincrement",
    "velocityinc",
    "velinc",
];

/// A time between stamps is that of one increment when it is within this share of the usual one.
const NEAR: f64 = 0.5;

/// Intervals may scatter by this share, root mean square, before it is told.
const STEADY: f64 = 0.01;

/// Standard gravity, m/s², which a resting accelerometer's noise is a share of.
const GRAVITY: f64 = 9.80665;

/// The sensor whose increments these words name, without their axis.
pub fn sensor(words: &[String]) -> Option<Sensor> {
    // No name in the lists is of more than two words.
    let tails = (1..=2).filter_map(|count| words.get(words.len().checked_sub(count)?..));
    tails.map(|tail| tail.concat()).find_map(|tail| sensor_in_one_piece(&tail))
}

/// The same of a single word.
pub fn sensor_in_one_piece(word: &str) -> Option<Sensor> {
    if ANGLES.contains(&word) {
        return Some(Sensor::Gyroscope);
    }
    VELOCITIES.contains(&word).then_some(Sensor::Accelerometer)
}

/// What columns hold by their names. Where a sensor has its axes both as readings and as increments, the
/// increments are set aside.
pub fn meanings(names: &[Name], hint: Option<Sensor>) -> Vec<Column> {
    let mut columns: Vec<Column> = names.iter().map(|name| name.meaning(hint)).collect();
    for axis in [Column::Rate, Column::Force] {
        let axes = [0, 1, 2].map(axis);
        let whole = |increments: bool| {
            axes.iter().all(|axis| {
                let mut all = columns.iter().zip(names);
                all.any(|(column, name)| column == axis && name.is_increment() == increments)
            })
        };
        let aside = match (whole(false), whole(true)) {
            (true, _) => true,
            (false, true) => false,
            (false, false) => continue,
        };
        for (column, name) in columns.iter_mut().zip(names) {
            if axes.contains(column) && name.is_increment() == aside {
                *column = Column::Other;
            }
        }
    }
    columns
}

/// Divides the increments of a table, block by block; of a table of rates it does nothing.
pub struct Increments {
    /// What sentences call the table.
    table: String,
    gyroscope: Option<Intervals>,
    accelerometer: Option<Intervals>,
}

impl Increments {
    /// Those of the table `table`, whose columns are these.
    pub fn of(columns: &Columns, table: String) -> Self {
        let intervals = |are: bool| are.then(Intervals::default);
        Self {
            table,
            gyroscope: intervals(columns.angles && columns.has(Column::Rate(0))),
            accelerometer: intervals(columns.velocities && columns.has(Column::Force(0))),
        }
    }

    /// That they are divided, if there are any.
    pub fn remark(&self) -> Option<Note> {
        let what = match (&self.gyroscope, &self.accelerometer) {
            (None, None) => return None,
            (Some(_), Some(_)) => "angle and velocity",
            (Some(_), None) => "angle",
            (None, Some(_)) => "velocity",
        };
        Some(Note::Info(format!(
            "{} holds increments of {what}: each is divided by the time since the row before it, and read \
             as the mean over that time",
            self.table
        )))
    }

    /// Turns the increments of a block, the next one of the table, into means.
    ///
    /// # Errors
    /// When there is no time to divide by, because all are of one instant.
    pub fn divide(&mut self, block: &mut Block) -> Result<(), Error> {
        let sensors = [
            (&mut self.gyroscope, &mut block.gyroscope, "angle"),
            (&mut self.accelerometer, &mut block.accelerometer, "velocity"),
        ];
        for (intervals, samples, what) in sensors {
            let Some(intervals) = intervals.as_mut().filter(|_| !samples.is_empty()) else {
                continue;
            };
            intervals.divide(samples).ok_or_else(|| {
                Error::data(format!(
                    "{} begins with increments of {what} of one instant only: the time that they are to be \
                     divided by, that since the row before, cannot be told",
                    self.table
                ))
            })?;
        }
        Ok(())
    }

    /// What the end of the table shows, once: that its stamps were no good to divide by.
    pub fn verdict(&mut self) -> Option<Note> {
        let (angles, velocities) = (self.gyroscope.take(), self.accelerometer.take());
        let all = [&angles, &velocities].into_iter().flatten();
        let scatter = all.map(Intervals::scatter).fold(0.0, f64::max);
        if scatter <= STEADY {
            return None;
        }
        let gravity = match velocities {
            Some(_) => format!(", {:.2} m/s² of gravity,", scatter * GRAVITY),
            None => String::new(),
        };
        Some(Note::Warning(format!(
            "the times between the stamps of {} scatter by {:.1} % (rms), and its increments were divided by \
             them: that share of each reading{gravity} is noise now, which imu calibrate takes for the sensor's \
             own; if a column counts the sensor's own time, take that with --map t=NAME,gx=NAME,…",
            self.table,
            100.0 * scatter
        )))
    }
}

/// The times between the stamps of one sensor.
#[derive(Default)]
struct Intervals {
    /// The usual one, ns, once there were two stamps.
    usual_ns: Option<f64>,
    before_ns: Option<i64>,
    /// Of those that are near the usual one, as shares beyond it: how many, their sum, that of their squares.
    near: u64,
    sum: f64,
    squares: f64,
}

impl Intervals {
    /// Divides samples that follow those before; `None` where no two stamps tell a time.
    fn divide(&mut self, samples: &mut [Sample]) -> Option<()> {
        let usual_ns = match self.usual_ns {
            Some(usual_ns) => usual_ns,
            None => *self.usual_ns.insert(median_ns(samples)?),
        };
        for sample in samples {
            let before_ns = self.before_ns.replace(sample.stamp_ns);
            let since_ns =
                before_ns.map(|before_ns| sample.stamp_ns.saturating_sub(before_ns) as f64);
            let beyond = since_ns.map(|since_ns| since_ns / usual_ns - 1.0);
            let interval_ns = match (since_ns, beyond) {
                (Some(since_ns), Some(beyond)) if beyond.abs() <= NEAR => {
                    self.near += 1;
                    self.sum += beyond;
                    self.squares += beyond * beyond;
                    since_ns
                }
                _ => usual_ns,
            };
            sample.value = sample.value.map(|increment| increment / (interval_ns / 1e9));
        }
        Some(())
    }

    /// The standard deviation of those near the usual one, as a share of it.
    fn scatter(&self) -> f64 {
        let count = self.near.max(1) as f64;
        let mean = self.sum / count;
        (self.squares / count - mean * mean).max(0.0).sqrt()
    }
}

/// The median of the times from stamp to later stamp, ns.
fn median_ns(samples: &[Sample]) -> Option<f64> {
    let pairs = samples.iter().zip(samples.iter().skip(1));
    let times = pairs.map(|(before, sample)| sample.stamp_ns.saturating_sub(before.stamp_ns));
    let mut times: Vec<i64> = times.filter(|time| *time > 0).collect();
    times.sort_unstable();
    times.get(times.len() / 2).map(|time| *time as f64)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::path::Path;

    use super::*;
    use crate::recording::{ReadOptions, SampleKind, read_from};

    const OURS: &str = "timestamp [ns],delta_angle_x [rad],delta_angle_y [rad],delta_angle_z [rad],\
                        delta_velocity_x [m/s],delta_velocity_y [m/s],delta_velocity_z [m/s]\n";

    /// All samples of a table, what they are, and what is told.
    fn read(text: &str) -> Result<(Block, Option<SampleKind>, Vec<Note>), Error> {
        let stream = Box::new(Cursor::new(text.to_owned().into_bytes()));
        let mut source = read_from(Path::new("a.csv"), stream, &ReadOptions::default())?;
        let (mut all, mut block) = (Block::default(), Block::default());
        while source.next_block(&mut block)? {
            all.gyroscope.append(&mut block.gyroscope);
            all.accelerometer.append(&mut block.accelerometer);
        }
        Ok((all, source.samples(), source.take_notes()))
    }

    /// A table of ours, each row of the same increments, at these ms.
    fn table(stamps_ms: impl IntoIterator<Item = i64>) -> String {
        let row = |ms: i64| format!("{},0.005,0,0,0,0,0.05\n", ms * 1_000_000);
        OURS.to_owned() + &stamps_ms.into_iter().map(row).collect::<String>()
    }

    #[test]
    fn each_is_over_its_own_interval_and_never_over_a_gap() {
        let (block, samples, notes) = read(&table([0, 5, 10, 30, 35, 35, 41])).unwrap();
        assert_eq!(samples, Some(SampleKind::Mean));
        let rates: Vec<f64> = block.gyroscope.iter().map(|sample| sample.value[0]).collect();
        // The first, one behind a gap and a repeated stamp: by the usual 5 ms.
        assert_eq!(rates, [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.005 / 0.006]);
        let forces = block.accelerometer.iter().map(|sample| sample.value[2]);
        assert_eq!(forces.collect::<Vec<_>>()[..3], [0.05 / 0.005; 3]);
        assert!(
            matches!(&notes[..], [Note::Info(text), Note::Warning(_)]
                if text.contains("a.csv holds increments of angle and velocity: each is divided")),
            "{notes:?}"
        );
    }

    #[test]
    fn sensors_have_times_of_their_own() {
        let rows = "0,0.1,0,0,,,\n4000000,,,,0,0,1\n5000000,0.1,0,0,,,\n24000000,,,,0,0,1\n";
        let (block, ..) = read(&format!("{OURS}{rows}")).unwrap();
        assert!(block.gyroscope.iter().all(|sample| sample.value[0] == 0.1 / 0.005));
        assert!(block.accelerometer.iter().all(|sample| sample.value[2] == 1.0 / 0.02));
    }

    #[test]
    fn blocks_follow_one_another() {
        // A gap where the second block begins.
        let stamps = (0..4096).chain(4100..5000).map(|at| 5 * at);
        let (block, _, notes) = read(&table(stamps)).unwrap();
        assert_eq!(block.gyroscope.len(), 4996);
        assert!(block.gyroscope.iter().all(|sample| sample.value[0] == 1.0));
        assert_eq!(notes.len(), 1, "{notes:?}");
    }

    #[test]
    fn one_instant_has_no_interval() {
        for rows in [&[7][..], &[7, 7]] {
            let why = read(&table(rows.iter().copied())).unwrap_err().to_string();
            assert!(
                why.contains("a.csv begins with increments of angle of one instant only"),
                "{why}"
            );
        }
    }

    #[test]
    fn stamps_that_jitter_are_told() {
        // 5.1 and 4.9 ms in turns: 2 % of the former, 0.19 m/s²; where 5.04 and 4.96 ms are 0.8 %.
        let jittered = |by_us: i64| {
            let row = |i: i64| format!("{},0,0,0,0,0,0\n", 5_000_000 * i + 500 * by_us * (i % 2));
            read(&(OURS.to_owned() + &(0..100).map(row).collect::<String>())).unwrap().2
        };
        let notes = jittered(200);
        let [_, Note::Warning(why)] = &notes[..] else { panic!("{notes:?}") };
        assert!(
            why.contains("scatter by 2.0 % (rms)") && why.contains("0.19 m/s² of gravity"),
            "{why}"
        );
        assert_eq!(jittered(80).len(), 1);
    }

    #[test]
    fn names_and_units_that_people_write() {
        let degree = std::f64::consts::PI / 180.0;
        for (header, angle, velocity) in [
            ("t [s],dtheta_x,dtheta_y,dtheta_z,dvel_x,dvel_y,dvel_z", 1.0, 1.0),
            ("t [s],dthetax,dthetay,dthetaz,dvx,dvy,dvz", 1.0, 1.0),
            ("time_s,DeltaThetaX,DeltaThetaY,DeltaThetaZ,DeltaVelX,DeltaVelY,DeltaVelZ", 1.0, 1.0),
            (
                "t_s,delta_theta_x (deg),delta_theta_y (deg),delta_theta_z (deg),\
                 delta_v_x [m/s],delta_v_y [m/s],delta_v_z [m/s]",
                degree,
                1.0,
            ),
            (
                "t_s,delta_angle_x_deg,delta_angle_y_deg,delta_angle_z_deg,\
                 delta_velocity_x_m_s,delta_velocity_y_m_s,delta_velocity_z_m_s",
                degree,
                1.0,
            ),
            (
                "t_s,dtheta_mrad_x,dtheta_mrad_y,dtheta_mrad_z,dvel_m_s_x,dvel_m_s_y,dvel_m_s_z",
                1e-3,
                1.0,
            ),
            (
                "t [s],imu.delta_angle[0],imu.delta_angle[1],imu.delta_angle[2],\
                 imu.delta_velocity[0],imu.delta_velocity[1],imu.delta_velocity[2]",
                1.0,
                1.0,
            ),
            (
                "t [s],angle_increment_x [arcsec],angle_increment_y [arcsec],\
                 angle_increment_z [arcsec],VelInc_X [g·s],VelInc_Y [g·s],VelInc_Z [g·s]",
                degree / 3600.0,
                9.80665,
            ),
            (
                "t,dtheta_x,dtheta_y,dtheta_z,dv_x,dv_y,dv_z\n\
                 [s],[deg],[deg],[deg],[m s^-1],[m s^-1],[m s^-1]",
                degree,
                1.0,
            ),
        ] {
            let text = format!("{header}\n0,1,0,0,0,0,1\n0.5,1,0,0,0,0,1\n");
            let (block, samples, _) = read(&text).unwrap_or_else(|why| panic!("{header}: {why}"));
            assert_eq!(samples, Some(SampleKind::Mean), "{header}");
            assert_eq!(block.gyroscope[1].value[0], angle / 0.5, "{header}");
            assert_eq!(block.accelerometer[1].value[2], velocity / 0.5, "{header}");
        }
        let header = OURS.replace("_x [rad]", "_x [rad/s]");
        let why = read(&format!("{header}0,1,0,0,0,0,1\n")).unwrap_err().to_string();
        assert!(why.contains("'rad/s' is no unit of increments of angle: use rad"), "{why}");
    }

    #[test]
    fn readings_stand_before_increments() {
        let header = "t [s],dvx,dvy,dvz,gx,gy,gz,ax,ay,az,dtheta_x,dtheta_y,dtheta_z\n";
        let rows = "0,9,9,9,1,2,3,4,5,6,9,9,9\n0.5,9,9,9,1,2,3,4,5,6,9,9,9\n";
        let (block, samples, notes) = read(&format!("{header}{rows}")).unwrap();
        assert_eq!(samples, None, "{notes:?}");
        assert_eq!(block.gyroscope[1].value, [1.0, 2.0, 3.0]);
        assert_eq!(block.accelerometer[1].value, [4.0, 5.0, 6.0]);
        // One sensor of either kind.
        let header = "t [s],dvx,dvy,dvz,gyro_x,gyro_y,gyro_z\n";
        let (block, samples, notes) =
            read(&format!("{header}0,1,0,0,1,2,3\n0.5,1,0,0,1,2,3\n")).unwrap();
        assert_eq!((samples, block.accelerometer[1].value[0]), (Some(SampleKind::Mean), 2.0));
        assert_eq!(block.gyroscope[1].value, [1.0, 2.0, 3.0], "{notes:?}");
    }
}
