//! The truth of a recording, front to back, with as much of it at hand as a start needs.

use std::collections::VecDeque;

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::Bias;

use super::motion::Motion;
use crate::error::Error;
use crate::recording::Note;
use crate::recording::poses::{Pose, Poses};

/// Poses so near an instant tell the velocity there, ns.
const NEAR_NS: i64 = 100_000_000;
/// Between poses that are further apart than this nothing is known, ns.
const HOLE_NS: i64 = 500_000_000;

/// What is true at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    pub(super) stamp_ns: i64,
    pub(super) motion: Motion,
    pub(super) bias: Option<Bias<f64>>,
}

/// What is true at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Begin {
    pub(super) motion: Motion,
    pub(super) bias: Option<Bias<f64>>,
    /// The velocity comes from differences of poses.
    pub(super) differenced: bool,
}

/// The truth being read.
pub struct Truth {
    poses: Poses,
    /// What was read and is still of use, in order.
    at_hand: VecDeque<Known>,
    /// How many of these were handed on.
    handed: usize,
    last_ns: Option<i64>,
    /// Stamps of the first pose and of the last one that was read, ns.
    span_ns: Option<(i64, i64)>,
    /// Poses that were not after the one before, or not numbers.
    pub(super) left_out: u64,
    ended: bool,
}

impl Truth {
    /// The truth that these poses are, none of which was read.
    #[must_use]
    pub fn of(poses: Poses) -> Self {
        Self {
            poses,
            at_hand: VecDeque::new(),
            handed: 0,
            last_ns: None,
            span_ns: None,
            left_out: 0,
            ended: false,
        }
    }

    /// What there is to tell of its source, once nothing more is wanted of it.
    pub(super) fn finish(&mut self) -> Result<Vec<Note>, Error> {
        self.poses.finish()
    }

    /// First and last stamp of what was read so far, ns.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        self.span_ns
    }

    /// Reads one more.
    fn read(&mut self) -> Result<bool, Error> {
        while !self.ended {
            let Some(pose) = self.poses.next_pose()? else {
                self.ended = true;
                break;
            };
            let known = known(&pose).filter(|k| self.last_ns.is_none_or(|last| k.stamp_ns > last));
            let Some(known) = known else {
                self.left_out += 1;
                continue;
            };
            self.last_ns = Some(known.stamp_ns);
            let first = self.span_ns.map_or(known.stamp_ns, |(first, _)| first);
            self.span_ns = Some((first, known.stamp_ns));
            self.at_hand.push_back(known);
            return Ok(true);
        }
        Ok(false)
    }

    /// The next instant that was not handed on yet, if it is not later than this stamp.
    pub(super) fn next_until(&mut self, stamp_ns: i64) -> Result<Option<Known>, Error> {
        if self.handed == self.at_hand.len() && !self.read()? {
            return Ok(None);
        }
        let next = self.at_hand.get(self.handed).copied();
        let Some(next) = next.filter(|known| known.stamp_ns <= stamp_ns) else { return Ok(None) };
        self.handed += 1;
        // One pose before is kept for what lies between, and what is near for the velocity.
        let old = next.stamp_ns.saturating_sub(NEAR_NS);
        while self.handed > 1 && self.at_hand.get(1).is_some_and(|known| known.stamp_ns < old) {
            self.at_hand.pop_front();
            self.handed -= 1;
        }
        Ok(Some(next))
    }

    /// Passes over all instants up to this stamp.
    pub(super) fn skip_until(&mut self, stamp_ns: i64) -> Result<(), Error> {
        while self.next_until(stamp_ns)?.is_some() {}
        Ok(())
    }

    /// What is true at this stamp, whose past was passed over; none before the truth begins, in its holes and behind
    /// its end.
    pub(super) fn begin(&mut self, stamp_ns: i64) -> Result<Option<Begin>, Error> {
        let until = stamp_ns.saturating_add(NEAR_NS);
        while self.last_ns.is_none_or(|last| last < until) && self.read()? {}
        let after = self.at_hand.partition_point(|known| known.stamp_ns < stamp_ns);
        let Some(later) = self.at_hand.get(after).copied() else { return Ok(None) };
        let mut begin = if later.stamp_ns == stamp_ns {
            Begin { motion: later.motion, bias: later.bias, differenced: false }
        } else {
            let Some(&earlier) = after.checked_sub(1).and_then(|before| self.at_hand.get(before))
            else {
                return Ok(None);
            };
            let span = later.stamp_ns.saturating_sub(earlier.stamp_ns);
            if span > HOLE_NS {
                return Ok(None);
            }
            let part = (stamp_ns - earlier.stamp_ns) as f64 / span as f64;
            let motion = earlier.motion.towards(&later.motion, span as f64 * 1e-9, part);
            Begin { motion, bias: earlier.bias, differenced: false }
        };
        if begin.motion.velocity_w.is_none() {
            begin.motion.velocity_w = self.velocity(stamp_ns);
            begin.differenced = true;
        }
        Ok(Some(begin).filter(|begin| begin.motion.velocity_w.is_some()))
    }

    /// The slope of the parabola that fits the positions near an instant best; of a line through the poses on both
    /// sides where there are too few.
    fn velocity(&self, stamp_ns: i64) -> Option<Vector3<f64>> {
        let seconds = |known: &Known| known.stamp_ns.saturating_sub(stamp_ns) as f64 * 1e-9;
        let near: Vec<&Known> = self
            .at_hand
            .iter()
            .filter(|k| k.stamp_ns.abs_diff(stamp_ns) <= NEAR_NS.unsigned_abs())
            .collect();
        let first = near.first().or(self.at_hand.front().as_ref())?.motion.position_w;
        if near.len() >= 4 {
            // Normal equations of c₀ + c₁τ + c₂τ² in units of the span; Cramer's rule for c₁.
            let scale = NEAR_NS as f64 * 1e-9;
            let (mut t, mut p) = ([0.0; 5], [Vector3::<f64>::zeros(); 3]);
            for known in &near {
                let tau = seconds(known) / scale;
                let from = known.motion.position_w - first;
                let powers = [1.0, tau, tau * tau, tau.powi(3), tau.powi(4)];
                t.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
                p.iter_mut().zip(powers).for_each(|(sum, power)| *sum += from * power);
            }
            let [n, t1, t2, t3, t4] = t;
            let determinant =
                n * (t2 * t4 - t3 * t3) - t1 * (t1 * t4 - t2 * t3) + t2 * (t1 * t3 - t2 * t2);
            let slope =
                p[0] * (t2 * t3 - t1 * t4) + p[1] * (n * t4 - t2 * t2) + p[2] * (t1 * t2 - n * t3);
            if determinant > 1e-9 {
                return Some(slope / (determinant * scale));
            }
        }
        let after = self.at_hand.partition_point(|k| k.stamp_ns <= stamp_ns);
        let after = after.clamp(1, self.at_hand.len().checked_sub(1)?.max(1));
        let (a, b) = (self.at_hand.get(after - 1)?, self.at_hand.get(after)?);
        Some((b.motion.position_w - a.motion.position_w) / (seconds(b) - seconds(a)))
    }
}

/// A pose as a motion; none where a number is missing.
fn known(pose: &Pose) -> Option<Known> {
    let [x, y, z, w] = pose.orientation;
    let length = (x * x + y * y + z * z + w * w).sqrt();
    let fine = (0.5..2.0).contains(&length) && pose.position.iter().all(|p| p.abs() < 1e12);
    let attitude_wb =
        fine.then(|| Quaternion::new(w / length, x / length, y / length, z / length))?;
    let velocity_w = pose.velocity.filter(|v| v.iter().all(|v| v.abs() < 1e12)).map(Vector3::from);
    let bias = pose.bias.and_then(|(rate, force)| Bias::new(rate.into(), force.into()).ok());
    let position_w = Vector3::from(pose.position);
    Some(Known {
        stamp_ns: pose.stamp_ns,
        motion: Motion { attitude_wb, velocity_w, position_w },
        bias,
    })
}
