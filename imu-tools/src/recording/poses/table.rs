//! Tables of poses, as TUM, EuRoC and `imu simulate` write them.
//!
//! TUM's: `timestamp tx ty tz qx qy qz qw`, blanks between, time in seconds, lines with `#` passed
//! over (Sturm et al. 2012). EuRoC's ground truth: a table whose header names `p_RS_R_x` … and
//! `q_RS_w` …, time in nanoseconds (Burri et al. 2016); TUM-VI's `mocap0/data.csv` likewise. The truth of
//! `imu simulate` is such a table too; where its clock errs, rows have the stamp of the recording, and those of lost
//! samples are passed over.

use super::Pose;
use crate::error::Error;
use crate::recording::Note;
use crate::recording::csv::dialect::Dialect;
use crate::recording::csv::number;
use crate::recording::input::{Input, LARGEST_PIECE};

/// Seconds since 1970 beyond which no stamp is: the nanoseconds of 64 bits end.
const LATEST_S: i64 = 9_200_000_000;
/// So much of the start is looked at.
const AHEAD: usize = 64 * 1024;

/// A table of poses being read, front to back.
pub struct Table {
    input: Input,
    format: Format,
    line: u64,
    is_cut: bool,
}

/// Where its numbers stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Format {
    dialect: Dialect,
    /// Power of ten between its time and nanoseconds.
    exponent: u32,
    /// The column of its time.
    time: usize,
    position: [usize; 3],
    /// x, y, z, w.
    orientation: [usize; 4],
    velocity: Option<[usize; 3]>,
    bias: Option<([usize; 3], [usize; 3])>,
    /// Rows without a stamp are passed over.
    unstamped: bool,
    /// It holds angular rates and specific forces as well.
    imu: bool,
}

impl Format {
    /// The format that a table begins with; `None` where it holds no poses.
    fn of(start: &[u8]) -> Option<Self> {
        let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
        let mut lines = start.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
        let mut header = None;
        let first = lines.find(|line| {
            let dialect = Dialect::of(line);
            let row = dialect.fields(line).next().is_some_and(|f| number::value(f).is_some());
            if !row && header.is_none() {
                header = Self::named(line);
            }
            row
        })?;
        header.or_else(|| Self::plain(first))
    }

    /// EuRoC's, by the names in its header.
    fn named(line: &[u8]) -> Option<Self> {
        let text = String::from_utf8_lossy(line).to_lowercase();
        let dialect = Dialect::of(line);
        let names: Vec<&str> = text
            .split(',')
            .map(|name| name.split('[').next().unwrap_or(name).trim_matches([' ', '#', '\r']))
            .collect();
        let at = |kind: &str, axis: &str| {
            names.iter().position(|name| {
                let rest = name.strip_prefix(kind).and_then(|rest| rest.strip_prefix('_'));
                rest.is_some_and(|rest| rest.split('_').any(|word| word == axis))
            })
        };
        let three = |kind: &str| Some([at(kind, "x")?, at(kind, "y")?, at(kind, "z")?]);
        let either = |euroc: &str, own: &str| three(euroc).or_else(|| three(own));
        let stamp = names.iter().position(|name| *name == "stamp_ns");
        Some(Self {
            dialect,
            exponent: 0,
            time: stamp.unwrap_or(0),
            position: three("p")?,
            orientation: [at("q", "x")?, at("q", "y")?, at("q", "z")?, at("q", "w")?],
            velocity: three("v"),
            bias: either("b_w", "gyro_bias").zip(either("b_a", "accel_bias")),
            unstamped: stamp.is_some(),
            imu: three("rate").is_some() && three("force").is_some(),
        })
    }

    /// TUM's: eight numbers, the last four of them a rotation.
    fn plain(row: &[u8]) -> Option<Self> {
        let format = Self::of_tum(row);
        let pose = format.pose(row)?;
        // Six decimals are the least that such files have.
        (format.is_eight(row) && (pose.length() - 1.0).abs() < 1e-3).then_some(format)
    }

    fn of_tum(row: &[u8]) -> Self {
        Self {
            dialect: Dialect::of(row),
            exponent: 9,
            time: 0,
            position: [1, 2, 3],
            orientation: [4, 5, 6, 7],
            velocity: None,
            bias: None,
            unstamped: false,
            imu: false,
        }
    }

    fn is_eight(&self, row: &[u8]) -> bool {
        self.dialect.fields(row).count() == 8
    }

    /// Why a table of eight numbers is none of poses; the end of a sentence.
    fn why_not(start: &[u8]) -> String {
        let lines = start.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
        let in_nanoseconds = |line: &[u8]| Self { exponent: 0, ..Self::of_tum(line) }.pose(line);
        if lines.clone().any(|l| {
            Self::plain(l).is_none()
                && in_nanoseconds(l).is_some_and(|pose| pose.stamp_ns > LATEST_S)
        }) {
            return ": the first column is beyond any time in seconds, and TUM's stamps are seconds"
                .into();
        }
        let rows = lines.filter_map(|line| {
            let format = Self::of_tum(line);
            format.pose(line).filter(|_| format.is_eight(line))
        });
        let bad = rows.take(1).find(|pose| pose.length().is_finite());
        bad.map_or(String::new(), |pose| {
            format!(
                "; the last four numbers of a row have the length {:.6}, no rotation's{}",
                pose.length(),
                pose.hint()
            )
        })
    }

    fn pose(&self, row: &[u8]) -> Option<Pose> {
        let fields: Vec<&[u8]> = self.dialect.fields(row).collect();
        let number = |at: usize| fields.get(at).and_then(|field| number::value(field));
        let [x, y, z] = self.position.map(number);
        let [qx, qy, qz, qw] = self.orientation.map(number);
        let three = |at: [usize; 3]| {
            let [x, y, z] = at.map(number);
            Some([x?, y?, z?])
        };
        let bias = self.bias.and_then(|(rate, force)| three(rate).zip(three(force)));
        Some(Pose {
            stamp_ns: number::nanoseconds(fields.get(self.time)?, self.exponent)?,
            position: [x?, y?, z?],
            orientation: [qx?, qy?, qz?, qw?],
            velocity: self.velocity.and_then(three),
            bias,
        })
    }

    /// Whether a row is one of a sample that was lost.
    fn is_lost(&self, row: &[u8]) -> bool {
        self.unstamped && self.dialect.fields(row).nth(self.time).is_some_and(<[u8]>::is_empty)
    }
}

impl Table {
    /// Whether a file begins as a trajectory does.
    pub fn are_in(input: &mut Input) -> Result<bool, Error> {
        input.fill(AHEAD)?;
        Ok(Format::of(input.at_hand()).is_some_and(|format| !format.imu))
    }

    /// Reads the trajectory in `input`.
    pub fn of(mut input: Input) -> Result<Self, Error> {
        input.fill(AHEAD)?;
        let format = Format::of(input.at_hand()).ok_or_else(|| {
            Error::data(format!(
                "{} holds no poses as TUM or EuRoC write them{}",
                input.path().display(),
                Format::why_not(input.at_hand())
            ))
        })?;
        Ok(Self { input, format, line: 0, is_cut: false })
    }

    /// The line of the last pose, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// What there is to tell at its end.
    pub fn note(&self) -> Option<Note> {
        self.is_cut.then(|| Note::Warning(format!("line {} is cut off and left out", self.line)))
    }

    /// The next pose; `None` at the end, which a row that is cut off is as well.
    ///
    /// # Errors
    /// When the file cannot be read, or a row is none.
    pub fn next_pose(&mut self) -> Result<Option<Pose>, Error> {
        loop {
            let mut seen = 0;
            let len = loop {
                let unseen = self.input.at_hand().get(seen..).unwrap_or_default();
                if let Some(end) = memchr::memchr(b'\n', unseen) {
                    break seen + end + 1;
                }
                seen = self.input.at_hand().len();
                if seen < LARGEST_PIECE && self.input.fill(seen + 1)? {
                    continue;
                }
                break seen;
            };
            if len == 0 {
                return Ok(None);
            }
            self.line += 1;
            let line = self.input.at_hand().get(..len).unwrap_or_default();
            let (row, whole) = (line.trim_ascii(), line.ends_with(b"\n"));
            let row = row.strip_prefix(b"\xef\xbb\xbf").unwrap_or(row);
            let aside = matches!(row.first(), None | Some(b'#' | b'%'));
            let pose = self.format.pose(row);
            // A header without # is the first line.
            let header = self.line == 1 && pose.is_none();
            let lost = pose.is_none() && self.format.is_lost(row);
            self.input.consume(len);
            match pose {
                Some(pose) if !aside => return Ok(Some(pose)),
                None if !aside && !header && !lost => {
                    if !whole {
                        self.is_cut = true;
                        return Ok(None);
                    }
                    return Err(Error::data(format!(
                        "{}, line {}: this is no pose",
                        self.input.path().display(),
                        self.line
                    )));
                }
                _ => {}
            }
        }
    }

    /// The error for who looks for an IMU here.
    pub fn no_samples(mut self) -> Error {
        let mut poses = 0_u64;
        while matches!(self.next_pose(), Ok(Some(_))) {
            poses += 1;
        }
        Error::data(format!(
            "{} holds {poses} poses and no IMU samples: name the recording of the IMU itself",
            self.input.path().display()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn poses(text: &str) -> Result<Vec<Pose>, Error> {
        let stream = Box::new(std::io::Cursor::new(text.as_bytes().to_vec()));
        let mut poses = Table::of(Input::pipe(Path::new("a"), stream))?;
        let mut all = Vec::new();
        while let Some(pose) = poses.next_pose()? {
            all.push(pose);
        }
        Ok(all)
    }

    #[test]
    fn both_formats_say_the_same() {
        let expected = Pose {
            stamp_ns: 1_403_636_580_838_555_648,
            position: [4.688319, -1.786938, 0.783338],
            orientation: [-0.153029, -0.827383, -0.082152, 0.534108],
            velocity: None,
            bias: None,
        };
        for text in [
            "1403636580.838555648 4.688319 -1.786938 0.783338 -0.153029 -0.827383 -0.082152 0.534108\n",
            "# timestamp tx ty tz qx qy qz qw\n\
             1403636580.838555648 4.688319 -1.786938 0.783338 -0.153029 -0.827383 -0.082152 0.534108",
            "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], \
             q_RS_z [], v_RS_R_x [m s^-1], b_w_RS_S_x [rad s^-1]\r\n\
             1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152,0,0\r\n",
            "timestamp,p_x,p_y,p_z,q_x,q_y,q_z,q_w\n\
             1403636580838555648,4.688319,-1.786938,0.783338,-0.153029,-0.827383,-0.082152,0.534108\n",
        ] {
            assert_eq!(poses(text).unwrap(), [expected], "{text}");
        }
    }

    #[test]
    fn what_a_table_of_truth_has_besides() {
        let euroc = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
             v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], \
             b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n\
             7,1,2,3,1,0,0,0,4,5,6,.1,.2,.3,.4,.5,.6\n";
        let [pose] = poses(euroc).unwrap()[..] else { panic!() };
        assert_eq!((pose.stamp_ns, pose.velocity), (7, Some([4.0, 5.0, 6.0])));
        assert_eq!(pose.bias, Some(([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])));
        // What `imu simulate` writes where the clock errs and samples are lost; it is a table of an IMU as well.
        let own = "t_ns,stamp_ns,p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,rate_x_rad_s,rate_y_rad_s,\
             rate_z_rad_s,force_x_m_s2,force_y_m_s2,force_z_m_s2,gyro_bias_x_rad_s,gyro_bias_y_rad_s,gyro_bias_z_rad_s,\
             accel_bias_x_m_s2,accel_bias_y_m_s2,accel_bias_z_m_s2\n\
             7,8,1,2,3,1,0,0,0,4,5,6,0,0,0,0,0,9.8,.1,.2,.3,.4,.5,.6\n\
             9,,1,2,3,1,0,0,0,4,5,6,0,0,0,0,0,9.8,.1,.2,.3,.4,.5,.6\n";
        assert_eq!(poses(own).unwrap(), [Pose { stamp_ns: 8, ..pose }]);
        let stream = Box::new(std::io::Cursor::new(own.as_bytes().to_vec()));
        assert!(!Table::are_in(&mut Input::pipe(Path::new("a"), stream)).unwrap());
    }

    #[test]
    fn imu_tables_are_no_poses() {
        for text in [
            "0.1 0 0 0 0 0 9.81 25\n",
            "0.1 0.01 0.02 0.03 0 0 1 25.5\n",
            "t,gx,gy,gz,ax,ay,az\n0,1,2,3,4,5,6\n",
            "",
            "hello\n",
        ] {
            assert!(poses(text).is_err(), "{text}");
        }
    }

    #[test]
    fn faults_and_cuts() {
        let row = "1 0 0 0 0 0 0 1\n";
        assert_eq!(poses(&format!("{row}{row}2 0 0")).unwrap().len(), 2);
        for (text, told) in [("2 0 0", Some("line 2 is cut off and left out")), (row, None)] {
            let stream = Box::new(std::io::Cursor::new(format!("{row}{text}").into_bytes()));
            let mut table = Table::of(Input::pipe(Path::new("a"), stream)).unwrap();
            while table.next_pose().unwrap().is_some() {}
            assert_eq!(table.note(), told.map(|text| Note::Warning(text.into())));
        }
        let error = poses(&format!("{row}oops\n{row}")).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
    }
}
