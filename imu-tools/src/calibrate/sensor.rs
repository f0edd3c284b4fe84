//! One sensor's way from samples to noise: stamps to a grid, values into a ladder, a fit.

use super::block_means::BlockMeans;
use super::checks::Checker;
use super::limits::Limits;
use super::stillness::Stillness;
use super::{Estimator, Options, SensorKind, SensorLadder, SensorNoise, Stretch, fits};
use crate::recording::{Event, Sample, Timeline};

/// Takes the samples of one sensor as they come.
pub(super) struct Pipeline {
    kind: SensorKind,
    options: Options,
    timeline: Timeline,
    checker: Checker,
    stillness: Stillness,
    taken: Taken,
    /// First and latest stamp, and how many.
    first_ns: Option<i64>,
    latest_ns: i64,
    samples: u64,
}

/// What becomes of values on the grid.
struct Taken {
    kind: SensorKind,
    /// Known when the first values of a record show what is normal.
    limits: Option<Limits>,
    ladder: SensorLadder,
    /// What the ladders of the records before this one gathered.
    earlier: Option<SensorLadder>,
    means: BlockMeans,
    /// Σ of values less the reference of this record, and how many.
    sum: [f64; 3],
    count: u64,
    /// Mean and count of the records before this one; a record without a sample has no count.
    records: Vec<([f64; 3], u64)>,
}

impl Pipeline {
    pub(super) fn new(kind: SensorKind, options: &Options) -> Self {
        let taken = Taken {
            kind,
            limits: None,
            ladder: SensorLadder::new(),
            earlier: None,
            means: BlockMeans::new(),
            sum: [0.0; 3],
            count: 0,
            records: Vec::new(),
        };
        Self {
            kind,
            options: *options,
            timeline: Timeline::new(),
            checker: Checker::new(),
            stillness: Stillness::new(options.keep_all),
            taken,
            first_ns: None,
            latest_ns: i64::MIN,
            samples: 0,
        }
    }

    pub(super) fn push(&mut self, samples: &[Sample]) {
        if let (Some(first), Some(last)) = (samples.first(), samples.last()) {
            self.first_ns.get_or_insert(first.stamp_ns);
            self.latest_ns = self.latest_ns.max(last.stamp_ns);
            self.samples += samples.len() as u64;
        }
        let period_s = self.rough_period_s();
        let Self { timeline, checker, stillness, taken, .. } = self;
        timeline.push(samples, |event| {
            let limits = taken.limits(event);
            if let Event::Values(values) = event {
                checker.take(values);
            }
            stillness.take(event, period_s, limits, &mut |event| taken.take(event));
        });
    }

    /// Time between samples, near enough to say how many make a second.
    fn rough_period_s(&self) -> f64 {
        let span = self.latest_ns.saturating_sub(self.first_ns.unwrap_or(self.latest_ns));
        span as f64 * 1e-9 / self.samples as f64
    }

    /// Another record follows: no difference spans the break, all sums add.
    pub(super) fn next_record(&mut self) {
        let period_s = self.rough_period_s();
        let Self { timeline, checker, stillness, taken, .. } = self;
        timeline.next_record(|event| {
            let limits = taken.limits(event);
            if let Event::Values(values) = event {
                checker.take(values);
            }
            stillness.take(event, period_s, limits, &mut |event| taken.take(event));
        });
        stillness.next_record(&mut |event| taken.take(event));
        taken.close_record();
        self.first_ns = None;
        self.latest_ns = i64::MIN;
        self.samples = 0;
    }

    /// The noise, of a topic yet to be named, or nothing if there was not a sample.
    pub(super) fn finish(self) -> Option<SensorNoise> {
        let period_s = self.rough_period_s();
        let Self { kind, options, timeline, mut checker, mut stillness, mut taken, .. } = self;
        let stamps = timeline.finish(|event| {
            let limits = taken.limits(event);
            if let Event::Values(values) = event {
                checker.take(values);
            }
            stillness.take(event, period_s, limits, &mut |event| taken.take(event));
        });
        let disturbed = stillness.finish(&mut |event| taken.take(event));
        taken.close_record();
        let ladder = taken.earlier?;
        let count = taken.records.iter().map(|(_, count)| count).sum::<u64>().max(1) as f64;
        let mut mean = [0.0; 3];
        for (of_record, samples) in &taken.records {
            let share = *samples as f64 / count;
            for (mean, of_record) in mean.iter_mut().zip(of_record) {
                *mean += share * of_record;
            }
        }
        let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
        let seconds = |samples: u64| samples as f64 * tau0_s;
        let means = &taken.means;
        let mut noise = fits::noise(kind, stamps, &ladder, means, mean, options.keep_all);
        noise.disturbed = disturbed
            .iter()
            .map(|s| Stretch { from_s: seconds(s.from), to_s: seconds(s.to) })
            .collect();
        noise.checks = checker.finish();
        noise.record_means = taken
            .records
            .iter()
            .enumerate()
            .filter(|(_, (_, count))| *count > 0)
            .map(|(record, (mean, _))| (record, *mean))
            .collect();
        match options.estimator {
            Estimator::Octaves => {}
            Estimator::MaximumLikelihood => noise.by_maximum_likelihood(means),
            Estimator::Slope => noise.by_slope(),
        }
        Some(noise)
    }
}

impl Taken {
    /// Puts the record at hand beside those before it; the next one has limits of its own.
    fn close_record(&mut self) {
        let limits = self.limits.take();
        if limits.is_some() {
            let ladder = std::mem::take(&mut self.ladder);
            match &mut self.earlier {
                Some(earlier) => earlier.pool(&ladder),
                None => self.earlier = Some(ladder),
            }
        }
        let count = std::mem::take(&mut self.count);
        let mut mean = limits.map_or([0.0; 3], |limits| limits.reference);
        for (mean, sum) in mean.iter_mut().zip(std::mem::take(&mut self.sum)) {
            *mean += sum / count.max(1) as f64;
        }
        self.records.push((mean, count));
    }

    /// The limits, learnt from the first values.
    fn limits(&mut self, event: Event<'_>) -> Option<Limits> {
        if self.limits.is_none()
            && let Event::Values(values) = event
        {
            let limits = Limits::of(self.kind, values);
            self.ladder =
                SensorLadder::with_reference(limits.reference, limits.bound).unwrap_or_default();
            self.means.next_record(limits.reference);
            self.limits = Some(limits);
        }
        self.limits
    }

    fn take(&mut self, event: Event<'_>) {
        let Some(limits) = self.limits else { return };
        match event {
            Event::Values(values) => {
                self.ladder.extend(values);
                if limits.hold_all(values) {
                    self.keep(values, &limits);
                } else {
                    for value in values {
                        if limits.hold(value) {
                            self.keep(std::slice::from_ref(value), &limits);
                        } else {
                            self.means.missing(1);
                        }
                    }
                }
            }
            Event::Missing(n) => {
                self.ladder.missing(n);
                self.means.missing(n);
            }
            Event::Restart => {
                self.ladder.restart();
                self.means.restart();
            }
        }
    }

    /// Takes values within the limits into the means.
    #[inline]
    fn keep(&mut self, values: &[[f64; 3]], limits: &Limits) {
        self.means.extend(values);
        for value in values {
            for ((sum, x), offset) in self.sum.iter_mut().zip(value).zip(limits.reference) {
                *sum += x - offset;
            }
        }
        self.count += values.len() as u64;
    }
}
