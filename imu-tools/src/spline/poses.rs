//! Poses of a file into what a fit takes: what makes no curve is refused, and what is doubtful told.
//!
//! Refused, with the line: what is no number, a quaternion whose length is off by more than 10⁻³, a stamp that goes
//! back, neighbours half a turn apart. Told: quaternions made unit, repeated stamps, holes, jumps of more than a
//! quarter turn, and columns whose order seems to be another (`order`). The sign of a quaternion does not matter.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::se3::Pose;
use imu_core::so3;

use super::distance::between;
use super::{FEWEST_POSES, TimedPose, order};
use crate::error::Error;
use crate::recording::Note;
use crate::recording::poses::{Pose as Row, Poses};

/// Off from unit length by more than what six decimals leave, a quaternion is told of.
const ROUNDED: f64 = 5e-6;
/// Off by more, it is none.
const OFF: f64 = 1e-3;
/// Turned further than this from the one before, a pose has no way to it.
const FURTHEST: f64 = PI - 0.01;
/// So many median steps between two poses are a hole.
const HOLE: f64 = 1.8;
/// So many of them are named.
const NAMED: usize = 3;

/// Poses that make a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// In the order of their stamps.
    pub poses: Vec<TimedPose>,
    /// What there is to tell of them.
    pub notes: Vec<Note>,
}

impl Given {
    /// Reads the poses at `path`, of TUM, EuRoC or `imu simulate`; `-` is a pipe.
    ///
    /// # Errors
    /// One sentence, with the line where there is one, for what makes no curve.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let name =
            if path == Path::new("-") { "the pipe".into() } else { path.display().to_string() };
        Self::of(name, Poses::open(path)?)
    }

    /// The same of a table that is open; errors call it `name`.
    pub(super) fn of(name: String, mut poses: Poses) -> Result<Self, Error> {
        let mut taken = Taken { name, ..Taken::default() };
        while let Some(pose) = poses.next_pose()? {
            taken.take(&pose, poses.line().unwrap_or(0))?;
        }
        let mut given = taken.given()?;
        given.notes.extend(poses.finish()?);
        Ok(given)
    }

    /// From the first pose to the last, s.
    #[must_use]
    pub fn span_s(&self) -> f64 {
        match (self.poses.first(), self.poses.last()) {
            (Some(first), Some(last)) => last.stamp_ns.abs_diff(first.stamp_ns) as f64 / 1e9,
            _ => 0.0,
        }
    }
}

/// Something that happened to several poses: how often, where first, and how much at most.
#[derive(Debug, Default)]
struct Tally {
    count: u64,
    first_line: u64,
    most: f64,
}

impl Tally {
    fn add(&mut self, line: u64, size: f64) {
        if self.count == 0 {
            self.first_line = line;
        }
        self.count += 1;
        self.most = self.most.max(size);
    }
}

/// Poses so far.
#[derive(Debug, Default)]
struct Taken {
    name: String,
    poses: Vec<TimedPose>,
    renormalised: Tally,
    repeated: u64,
    contradicting: Tally,
    /// By how much at most, rad.
    contradicting_turn: f64,
    jumps: Tally,
}

impl Taken {
    fn take(&mut self, given: &Row, line: u64) -> Result<(), Error> {
        let at = |sentence: String| Error::data(format!("{}, line {line}: {sentence}", self.name));
        let ([x, y, z], [qx, qy, qz, qw]) = (given.position, given.orientation);
        if ![x, y, z, qx, qy, qz, qw].iter().all(|number| number.is_finite()) {
            return Err(at("the pose has a value that is no number; take the row out".into()));
        }
        let rotation = Quaternion::new(qw, qx, qy, qz);
        let off = (so3::length(&rotation) - 1.0).abs();
        if off > OFF {
            let hint = given.hint();
            let length = so3::length(&rotation);
            return Err(at(format!(
                "the rotation has the length {length:.6}, and that of a unit quaternion is 1{hint}"
            )));
        }
        let pose = Pose::new(rotation, Vector3::new(x, y, z)).map_err(|_| {
            at(format!(
                "a position of {x:?}, {y:?}, {z:?} m is beyond any on Earth; metres are wanted"
            ))
        })?;
        let pose = TimedPose { stamp_ns: given.stamp_ns, pose };
        if off > ROUNDED {
            self.renormalised.add(line, off);
        }
        let Some(before) = self.poses.last() else {
            self.poses.push(pose);
            return Ok(());
        };
        let (apart, turn) = between(&before.pose, &pose.pose);
        if pose.stamp_ns < before.stamp_ns {
            let back = before.stamp_ns.abs_diff(pose.stamp_ns) as f64 / 1e9;
            return Err(at(format!(
                "the stamp is {back} s before that of the pose above; sort the file by time"
            )));
        }
        if pose.stamp_ns == before.stamp_ns {
            if apart > 0.0 || turn > 1e-9 {
                self.contradicting.add(line, apart);
                self.contradicting_turn = self.contradicting_turn.max(turn);
            } else {
                self.repeated += 1;
            }
            return Ok(());
        }
        if turn > FURTHEST {
            return Err(at(format!(
                "the pose is turned by {:.1}° from the one above, and half a turn has no direction; take wrong poses \
                 out, or give more of them",
                turn.to_degrees()
            )));
        }
        if turn > FRAC_PI_2 {
            self.jumps.add(line, turn);
        }
        self.poses.push(pose);
        Ok(())
    }

    fn given(self) -> Result<Given, Error> {
        let count = self.poses.len();
        if count < FEWEST_POSES {
            let poses = poses(count as u64);
            return Err(Error::data(format!(
                "{} holds {count} {poses} of different instants, and a curve needs {FEWEST_POSES} or more",
                self.name
            )));
        }
        let mut notes = Vec::new();
        if self.repeated > 0 {
            notes.push(Note::Info(match self.repeated {
                1 => "a pose is there twice, and taken once".into(),
                count => format!("{count} poses are there twice, and taken once"),
            }));
        }
        let mut warn = |sentence| notes.push(Note::Warning(sentence));
        let Tally { count, first_line, most } = self.renormalised;
        if count > 0 {
            warn(format!(
                "quaternions of {count} {} are not of unit length, by up to {most:.1e} (the first in line \
                 {first_line}): made so",
                poses(count)
            ));
        }
        let Tally { count, first_line, most } = self.contradicting;
        if count > 0 {
            warn(format!(
                "{count} {} with the stamp of the one above and another place or attitude, by up to {most:.3} m and \
                 {:.3}° (the first in line {first_line}): left out",
                poses(count),
                self.contradicting_turn.to_degrees()
            ));
        }
        let Tally { count, first_line, most } = self.jumps;
        if count > 0 {
            warn(format!(
                "{count} {} turned by more than a quarter turn from the one above, by up to {:.1}° (the first in line \
                 {first_line}): is that right?",
                poses(count),
                most.to_degrees()
            ));
        }
        notes.extend(holes(&self.poses).map(Note::Warning));
        notes.extend(order::suspicion(&self.poses).map(Note::Warning));
        Ok(Given { poses: self.poses, notes })
    }
}

/// The word for so many.
fn poses(count: u64) -> &'static str {
    if count == 1 { "pose" } else { "poses" }
}

/// What to tell of poses that are missing.
fn holes(given: &[TimedPose]) -> Option<String> {
    let step = |two: &[TimedPose]| two[1].stamp_ns.abs_diff(two[0].stamp_ns);
    let mut steps: Vec<u64> = given.windows(2).map(step).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable(middle).1 as f64;
    let begin = given.first()?.stamp_ns;
    let mut holes: Vec<(u64, f64)> = given
        .windows(2)
        .map(|two| (step(two), two[0].stamp_ns.abs_diff(begin) as f64 / 1e9))
        .filter(|(length, _)| *length as f64 > HOLE * median)
        .collect();
    if holes.is_empty() {
        return None;
    }
    holes.sort_by_key(|(length, _)| std::cmp::Reverse(*length));
    let named: Vec<String> = holes
        .iter()
        .take(NAMED)
        .map(|(length, at_s)| format!("{:.3} s after {at_s:.3} s", *length as f64 / 1e9))
        .collect();
    let missing: f64 =
        holes.iter().map(|(length, _)| (*length as f64 / median).round() - 1.0).sum();
    let longest = if holes.len() > NAMED { "the longest " } else { "" };
    let (poses, all) = (poses(missing as u64), holes.len());
    let holes = if all == 1 { "hole" } else { "holes" };
    Some(format!(
        "{missing} {poses} missing, {all} {holes} ({longest}{}): the curve across is a guess",
        named.join(", ")
    ))
}

#[cfg(test)]
#[path = "poses_tests.rs"]
mod tests;
