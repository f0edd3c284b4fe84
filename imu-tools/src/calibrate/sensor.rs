//! One sensor's way from samples to noise: stamps to a grid, values into a ladder, a fit.

use imu_core::allan::{
    AllanLadder, Difference, Octave, Parameter, Sampling, average_octaves, fit_noise,
    fit_noise_from, fitted_edf,
};

use super::block_means::BlockMeans;
use super::checks::{Checker, Checks};
use super::slope::{self, SlopeReading};
use super::stillness::Stillness;
use super::{AxisNoise, Deviation, Estimator, LEVELS, Options, SensorKind, SensorNoise, Stretch};
use super::{drift, maximum_likelihood};
use crate::recording::{Event, Sample, Summary, Timeline};

/// Windows a τ: statistically as good as full overlap.
const WINDOWS: usize = 4;

type SensorLadder = AllanLadder<f64, 3, LEVELS, WINDOWS>;

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

/// What a reading of the sensor can be: anything else is a glitch, and counts as missing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    reference: [f64; 3],
    bound: [f64; 3],
}

impl Limits {
    /// Around values like these: their median, and as a bound a thousand times their median absolute
    /// deviation. Where that is zero, or values are few, no sensor's range is beyond 1000 rad/s or
    /// 10 km/s².
    pub(super) fn of(kind: SensorKind, values: &[[f64; 3]]) -> Self {
        let range = match kind {
            SensorKind::Gyroscope => 1e3,
            SensorKind::Accelerometer => 1e4,
        };
        let (mut reference, mut bound) = ([0.0; 3], [range; 3]);
        for (axis, (reference, bound)) in reference.iter_mut().zip(&mut bound).enumerate() {
            let column = || values.iter().map(|row| row[axis]).filter(|x| x.is_finite());
            *reference = median(column().collect());
            let deviation = median(column().map(|x| (x - *reference).abs()).collect());
            if deviation > 0.0 && values.len() >= 64 {
                *bound = (1e3 * deviation).min(SensorLadder::limit());
            }
        }
        Self { reference, bound }
    }

    /// Whether a reading is within.
    #[inline]
    pub(super) fn hold(&self, value: &[f64; 3]) -> bool {
        let within = |axis: usize| (value[axis] - self.reference[axis]).abs() <= self.bound[axis];
        within(0) && within(1) && within(2) // false for a NaN
    }
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

    /// The noise, or nothing if there was not a sample.
    pub(super) fn finish(self, topic: &str) -> Option<SensorNoise> {
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
        let mut noise = noise(kind, topic, stamps, &ladder, means, mean, options.keep_all);
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
        self.means.next_record();
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
            self.limits = Some(limits);
        }
        self.limits
    }

    fn take(&mut self, event: Event<'_>) {
        let Some(limits) = self.limits else { return };
        match event {
            Event::Values(values) => {
                self.ladder.extend(values);
                self.means.extend(values);
                for value in values.iter().filter(|value| limits.hold(value)) {
                    for ((sum, x), offset) in self.sum.iter_mut().zip(value).zip(limits.reference) {
                        *sum += x - offset;
                    }
                    self.count += 1;
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
}

/// The middle value; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Reads the ladder and fits it.
fn noise(
    kind: SensorKind,
    topic: &str,
    stamps: Summary,
    ladder: &SensorLadder,
    means: &BlockMeans,
    mean: [f64; 3],
    keep_all: bool,
) -> SensorNoise {
    let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
    let sampling =
        Sampling { tau0_s, difference: Difference::Allan, windows: WINDOWS as u8, records: 1 };
    let whole = [0, 1, 2].map(|axis| ladder.octaves(axis));
    let from_of = |octaves: &[[Octave; LEVELS]; 3]| {
        octaves
            .iter()
            .filter_map(|axis| fit_noise(axis, sampling).contradiction)
            .max_by_key(|c| c.octave)
    };
    let drift = drift::examine(means, whole, tau0_s, from_of(&whole).map_or(0, |c| c.octave + 1));
    let octaves = if keep_all { whole } else { drift.octaves };

    // One axis that shows a low-pass filter speaks for all: they share the filter.
    let contradiction = from_of(&octaves);
    let from = contradiction.map_or(0, |c| c.octave + 1);
    let fits = octaves.map(|axis| fit_noise_from(&axis, sampling, from));
    // An axis that never changes is no record of noise.
    let live: Vec<_> = octaves.into_iter().filter(|axis| axis[0].variance > 0.0).collect();
    let together = Sampling { records: live.len() as u32, ..sampling };
    let pooled = fit_noise_from(&average_octaves(&live), together, from);
    let mut axes =
        fits.map(|f| AxisNoise { noise_density: f.noise_density, random_walk: f.random_walk });
    let mut pooled_noise =
        AxisNoise { noise_density: pooled.noise_density, random_walk: pooled.random_walk };
    let mut misfit = fits.map(|f| f.misfit);
    if let Some(ramp) = drift.ramp.filter(|_| !keep_all) {
        for ((axis, misfit), fit) in axes.iter_mut().zip(&mut misfit).zip(&ramp.axes) {
            axis.random_walk = fit.random_walk;
            *misfit = fit.misfit;
        }
        pooled_noise.random_walk = ramp.pooled.random_walk;
    }

    let tau = |octave: &Octave| octave.samples as f64 * tau0_s;
    let deviation = (0..LEVELS)
        .map(|level| octaves.map(|axis| axis[level]))
        .take_while(|octaves| octaves.iter().any(|o| o.differences > 0))
        .map(|octaves| {
            let mut edf = [0.0; 3];
            for ((edf, octave), fit) in edf.iter_mut().zip(&octaves).zip(&fits) {
                *edf = fitted_edf(octave, sampling, fit);
            }
            Deviation { tau_s: tau(&octaves[0]), octaves, edf }
        })
        .collect::<Vec<_>>();
    let at = |level: usize| octaves[0].get(level).map_or(0.0, tau);
    SensorNoise {
        kind,
        topic: topic.to_owned(),
        stamps,
        rejected: ladder.rejected_samples(),
        mean,
        record_means: Vec::new(),
        axes,
        pooled: pooled_noise,
        tau_used_s: pooled.used.map(|(first, last)| (at(first), at(last))),
        contradiction,
        misfit,
        disturbed: Vec::new(),
        warm_up_s: (drift.warm_up > 0).then_some(drift.warm_up as f64 * tau0_s),
        ramp: drift.ramp.map(|ramp| ramp.slope),
        checks: Checks::default(),
        deviation,
    }
}

impl SensorNoise {
    /// Puts the exact maximum likelihood in the place of the fit to octaves.
    fn by_maximum_likelihood(&mut self, means: &BlockMeans) {
        let tau0_s = self.tau0_s();
        let shortest_s = self.tau_used_s.map_or(0.0, |(first, _)| first);
        let found = maximum_likelihood::fit(means, tau0_s, shortest_s);
        self.axes = found.axes;
        self.pooled = found.pooled;
        self.tau_used_s = Some((found.block_s, self.stamps.span_s));
    }

    /// Puts the classic slope readings in the place of the fit; they have no interval, so theirs is
    /// all there is.
    fn by_slope(&mut self) {
        let axes = [0, 1, 2].map(|axis| self.curve(axis));
        let read = |axes: &[&[Octave]]| {
            let SlopeReading { noise_density, random_walk } =
                slope::kalibr_allan(axes, self.tau0_s());
            AxisNoise { noise_density: reading(noise_density), random_walk: reading(random_walk) }
        };
        let [x, y, z] = &axes;
        let found = axes.each_ref().map(|axis| read(&[axis]));
        self.pooled = read(&[x, y, z]);
        self.axes = found;
    }

    /// Time between samples, s; 0 where it is not known.
    #[must_use]
    pub fn tau0_s(&self) -> f64 {
        if self.stamps.rate_hz > 0.0 { 1.0 / self.stamps.rate_hz } else { 0.0 }
    }

    /// The octaves of one axis, shortest first.
    #[must_use]
    pub fn curve(&self, axis: usize) -> Vec<Octave> {
        self.deviation.iter().filter_map(|d| d.octaves.get(axis).copied()).collect()
    }
}

/// A number without an interval.
fn reading(value: Option<f64>) -> Parameter {
    match value {
        Some(value) => {
            Parameter::Observable { value, sd: f64::INFINITY, low90: 0.0, high90: f64::INFINITY }
        }
        None => Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }

    #[test]
    fn a_glitch_at_the_start_is_not_the_reference() {
        let mut values = vec![[0.0, 0.01, 9.8]; 100];
        for (k, row) in values.iter_mut().enumerate() {
            row[2] += 1e-3 * (k % 7) as f64;
        }
        values[0] = [1e4; 3];
        let limits = Limits::of(SensorKind::Accelerometer, &values);
        assert!((limits.reference[2] - 9.803).abs() < 1e-9);
        assert_eq!(values.iter().filter(|value| !limits.hold(value)).count(), 1);
        assert!(!limits.hold(&[0.0, f64::NAN, 9.8]));
    }
}
