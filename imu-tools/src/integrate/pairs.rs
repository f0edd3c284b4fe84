//! Both sensors in step: one reading of rate and force for every instant of the gyroscope.
//!
//! Where the accelerometer has a sample of the same stamp it is taken as it is, elsewhere (sensors with topics and rates
//! of their own) interpolated linearly between its neighbours, but not across a hole. What is not a number, and what
//! does not come after the sample before, is counted and left out.

use std::collections::VecDeque;

use imu_core::nalgebra::Vector3;
use imu_core::sample::Sample as Reading;

use crate::recording::{BLOCK_SAMPLES, Block, Sample};

/// So many periods without a sample are a hole.
pub const HOLE: i64 = 10;

/// Samples of one sensor that wait for the other, at most.
const HELD: usize = 4 * BLOCK_SAMPLES;

/// Rate and force at one stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) stamp_ns: i64,
    pub(super) reading: Reading<f64>,
}

/// What was left out, of both sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LeftOut {
    /// Not a number, or beyond any sensor.
    pub(super) impossible: u64,
    /// Of the stamp of the one before.
    pub(super) doubled: u64,
    /// Stamped before the one before, and the largest such step, ns.
    pub(super) backward: u64,
    pub(super) furthest_back_ns: i64,
}

/// Brings the two sensors in step.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    gyroscope: Line,
    accelerometer: Line,
    ended: bool,
    /// Samples of the gyroscope for which the accelerometer was interpolated.
    pub(super) interpolated: u64,
    /// Samples of the gyroscope without a sample of the accelerometer on both sides.
    pub(super) alone: u64,
}

impl Pairs {
    pub(super) fn take(&mut self, block: &Block) {
        self.gyroscope.take(&block.gyroscope);
        self.accelerometer.take(&block.accelerometer);
    }

    /// No more will come.
    pub(super) fn end(&mut self) {
        self.ended = true;
    }

    /// Samples of gyroscope and accelerometer that could be used.
    pub(super) fn counts(&self) -> (u64, u64) {
        (self.gyroscope.count, self.accelerometer.count)
    }

    pub(super) fn left_out(&self) -> LeftOut {
        let (a, b) = (&self.gyroscope.left_out, &self.accelerometer.left_out);
        LeftOut {
            impossible: a.impossible + b.impossible,
            doubled: a.doubled + b.doubled,
            backward: a.backward + b.backward,
            furthest_back_ns: a.furthest_back_ns.max(b.furthest_back_ns),
        }
    }

    /// The usual time between two readings, ns; none before there are two.
    pub(super) fn period_ns(&self) -> Option<i64> {
        self.gyroscope.period_ns()
    }

    /// The next reading, if it is complete.
    pub(super) fn next(&mut self) -> Option<Row> {
        let known = |line: &Line| line.steps_ns.len() == Line::FIRST;
        let periods_known = known(&self.gyroscope) && known(&self.accelerometer);
        if !(periods_known || self.ended || self.gyroscope.waiting.len() > HELD) {
            return None;
        }
        loop {
            let rate = *self.gyroscope.waiting.front()?;
            let forces = &mut self.accelerometer;
            while forces.waiting.get(1).is_some_and(|second| second.stamp_ns <= rate.stamp_ns) {
                forces.waiting.pop_front();
            }
            let force = match (forces.waiting.front(), forces.waiting.get(1)) {
                (Some(same), _) if same.stamp_ns == rate.stamp_ns => Some(same.value),
                (Some(before), Some(after)) if before.stamp_ns < rate.stamp_ns => {
                    let between = forces.between(before, after, rate.stamp_ns);
                    self.interpolated += u64::from(between.is_some());
                    between
                }
                (Some(later), _) if later.stamp_ns > rate.stamp_ns => None,
                _ if self.ended || self.gyroscope.waiting.len() > HELD => None,
                _ => return None,
            };
            self.gyroscope.waiting.pop_front();
            let reading = force.and_then(|force| {
                Reading::new(Vector3::from(rate.value), Vector3::from(force)).ok()
            });
            match reading {
                Some(reading) => return Some(Row { stamp_ns: rate.stamp_ns, reading }),
                None => self.alone += 1,
            }
        }
    }
}

/// The samples of one sensor in order.
#[derive(Debug, Default)]
struct Line {
    waiting: VecDeque<Sample>,
    last_ns: Option<i64>,
    /// The first steps, of which the middle one is the period.
    steps_ns: Vec<i64>,
    count: u64,
    left_out: LeftOut,
}

impl Line {
    /// So many steps show the period.
    const FIRST: usize = 100;

    fn take(&mut self, samples: &[Sample]) {
        for sample in samples {
            if Reading::new(Vector3::from(sample.value), Vector3::zeros()).is_err() {
                self.left_out.impossible += 1;
                continue;
            }
            if let Some(last) = self.last_ns {
                let step = sample.stamp_ns.saturating_sub(last);
                if step <= 0 {
                    self.left_out.doubled += u64::from(step == 0);
                    self.left_out.backward += u64::from(step < 0);
                    self.left_out.furthest_back_ns =
                        self.left_out.furthest_back_ns.max(step.saturating_neg());
                    continue;
                }
                if self.steps_ns.len() < Self::FIRST {
                    self.steps_ns.push(step);
                }
            }
            self.last_ns = Some(sample.stamp_ns);
            self.waiting.push_back(*sample);
            self.count += 1;
        }
    }

    fn period_ns(&self) -> Option<i64> {
        let mut steps = self.steps_ns.clone();
        let middle = steps.len() / 2;
        (!steps.is_empty()).then(|| *steps.select_nth_unstable(middle).1)
    }

    /// On the line between two samples, unless there is a hole between them.
    fn between(&self, before: &Sample, after: &Sample, stamp_ns: i64) -> Option<[f64; 3]> {
        let span = after.stamp_ns.saturating_sub(before.stamp_ns);
        if span > self.period_ns()?.saturating_mul(HOLE) {
            return None;
        }
        let part = (stamp_ns - before.stamp_ns) as f64 / span as f64;
        let mut axes = before.value.iter().zip(after.value);
        Some([(); 3].map(|()| axes.next().map_or(f64::NAN, |(a, b)| a + part * (b - a))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(stamps: impl IntoIterator<Item = i64>) -> Vec<Sample> {
        let value = |stamp_ns| [stamp_ns as f64 * 1e-3; 3];
        stamps.into_iter().map(|stamp_ns| Sample { stamp_ns, value: value(stamp_ns) }).collect()
    }

    fn rows(gyroscope: Vec<Sample>, accelerometer: Vec<Sample>) -> (Vec<Row>, Pairs) {
        let mut pairs = Pairs::default();
        pairs.take(&Block { gyroscope, accelerometer, ..Block::default() });
        pairs.end();
        let rows = std::iter::from_fn(|| pairs.next()).collect();
        (rows, pairs)
    }

    #[test]
    fn sensors_of_one_clock_need_no_interpolation() {
        let (rows, pairs) = rows(line(0..500), line(0..500));
        assert_eq!((rows.len(), pairs.interpolated, pairs.alone), (500, 0, 0));
        assert_eq!(pairs.period_ns(), Some(1));
    }

    #[test]
    fn a_slower_accelerometer_is_interpolated_but_not_across_a_hole() {
        let slow = (0..100).map(|i| 30 * i + 5).filter(|t| !(1000..2000).contains(t));
        let (rows, pairs) = rows(line((0..300).map(|i| 10 * i)), line(slow));
        // None before the first sample at 5, none in the hole from 995 to 2015, none after the last at 2975.
        assert_eq!(pairs.alone, 1 + 102 + 2);
        assert_eq!(rows.len(), 195);
        for row in &rows {
            let force = row.reading.specific_force().x;
            assert!((force - row.stamp_ns as f64 * 1e-3).abs() < 1e-12);
        }
    }

    #[test]
    fn what_cannot_be_is_counted() {
        let mut gyroscope = line([0, 10, 20, 20, 5, 30, 40]);
        gyroscope[1].value[2] = f64::NAN;
        let (rows, pairs) = rows(gyroscope, line([0, 10, 20, 30, 40]));
        assert_eq!(rows.iter().map(|row| row.stamp_ns).collect::<Vec<_>>(), [0, 20, 30, 40]);
        let LeftOut { impossible, doubled, backward, furthest_back_ns } = pairs.left_out();
        assert_eq!((impossible, doubled, backward, furthest_back_ns), (1, 1, 1, 15));
    }
}
