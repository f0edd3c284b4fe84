//! Trajectories on disk: a CSV with every digit, and TUM's format, which evo and its kin read.
//!
//! The CSV's columns are those of the truth of `imu simulate`: stamp in ns, position, attitude (q_wb, Hamilton, w
//! first), velocity. TUM's: seconds with nine decimals, x y z, qx qy qz qw (Sturm et al. 2012).

use std::io::Write as _;
use std::path::Path;

use imu_core::State;

use super::method::Method;
use crate::error::Error;
use crate::output::Output;
use crate::recording::poses;

/// Text is handed on when there is so much of it.
const PIECE: usize = 256 * 1024;

/// Both files of one rule in the making.
#[derive(Debug)]
pub(super) struct Writer {
    csv: (Output, Vec<u8>),
    tum: (Output, Vec<u8>),
}

/// The names of the files of one rule: CSV and TUM.
#[must_use]
pub fn file_names(method: Method) -> [String; 2] {
    ["csv", "tum"].map(|ending| format!("trajectory_{method}.{ending}"))
}

impl Writer {
    pub(super) fn create(folder: &Path, method: Method) -> Result<Self, Error> {
        let [csv, tum] = file_names(method).map(|name| folder.join(name));
        let header = "t_ns,p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s\n";
        Ok(Self {
            csv: (Output::create(&csv)?, header.into()),
            tum: (Output::create(&tum)?, poses::TUM_HEADER.into()),
        })
    }

    pub(super) fn write(&mut self, stamp_ns: i64, state: &State<f64>) -> Result<(), Error> {
        let (p, q, v) = (state.position_w(), state.attitude_wb(), state.velocity_w());
        let mut digits = zmij::Buffer::new();
        let (output, text) = &mut self.csv;
        // Writing to memory cannot fail.
        let _ = write!(text, "{stamp_ns}");
        for number in p.iter().chain([&q.w, &q.i, &q.j, &q.k]).chain(v.iter()) {
            text.push(b',');
            text.extend_from_slice(digits.format(*number).as_bytes());
        }
        text.push(b'\n');
        flush(output, text, PIECE)?;
        let (output, text) = &mut self.tum;
        poses::push_tum(text, stamp_ns, p.into(), [q.i, q.j, q.k, q.w]);
        flush(output, text, PIECE)
    }

    /// The complete files, which take their places when they are finished.
    pub(super) fn complete(mut self) -> Result<[Output; 2], Error> {
        for (output, text) in [&mut self.csv, &mut self.tum] {
            flush(output, text, 0)?;
        }
        Ok([self.csv.0, self.tum.0])
    }
}

fn flush(output: &mut Output, text: &mut Vec<u8>, above: usize) -> Result<(), Error> {
    if text.len() > above {
        output.write(text)?;
        text.clear();
    }
    Ok(())
}
