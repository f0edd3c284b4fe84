//! One sensor's way from samples to noise: stamps to a grid, values into a ladder, a fit.

use imu_core::allan::{
    AllanLadder, Difference, Octave, Parameter, Sampling, average_octaves, fit_noise,
    fit_noise_from, fitted_edf,
};

use super::block_means::BlockMeans;
use super::maximum_likelihood;
use super::slope::{self, SlopeReading};
use super::{AxisNoise, Deviation, Estimator, LEVELS, SensorKind, SensorNoise};
use crate::recording::{Event, Sample, Summary, Timeline};
use crate::scene::display_duration;

/// Windows a τ: statistically as good as full overlap.
const WINDOWS: usize = 4;

type SensorLadder = AllanLadder<f64, 3, LEVELS, WINDOWS>;

/// Takes the samples of one sensor as they come.
pub(super) struct Pipeline {
    kind: SensorKind,
    timeline: Timeline,
    taken: Taken,
}

/// What becomes of values on the grid.
struct Taken {
    kind: SensorKind,
    estimator: Estimator,
    /// Begun when the first values show what is normal.
    ladder: Option<SensorLadder>,
    /// What the ladders of the records before this one gathered.
    earlier: Option<SensorLadder>,
    /// Only for maximum likelihood.
    means: Option<BlockMeans>,
    /// Σ of values less the first reference of this record, and how many.
    sum: [f64; 3],
    offset: [f64; 3],
    count: u64,
    /// Mean and count of the records before this one; a record without a sample has no count.
    records: Vec<([f64; 3], u64)>,
}

impl Pipeline {
    pub(super) fn new(kind: SensorKind, estimator: Estimator) -> Self {
        let means = (estimator == Estimator::MaximumLikelihood).then(BlockMeans::new);
        let taken = Taken {
            kind,
            estimator,
            ladder: None,
            earlier: None,
            means,
            sum: [0.0; 3],
            offset: [0.0; 3],
            count: 0,
            records: Vec::new(),
        };
        Self { kind, timeline: Timeline::new(), taken }
    }

    pub(super) fn push(&mut self, samples: &[Sample]) {
        let taken = &mut self.taken;
        self.timeline.push(samples, |event| taken.take(event));
    }

    /// Another record follows: no difference spans the break, all sums add.
    pub(super) fn next_record(&mut self) {
        let taken = &mut self.taken;
        self.timeline.next_record(|event| taken.take(event));
        taken.close_record();
    }

    /// The noise, or nothing if there was not a sample.
    pub(super) fn finish(self, topic: &str) -> Option<SensorNoise> {
        let Self { kind, timeline, mut taken } = self;
        let stamps = timeline.finish(|event| taken.take(event));
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
        let mut noise = noise(kind, topic, stamps, &ladder, mean);
        noise.record_means = taken
            .records
            .iter()
            .enumerate()
            .filter(|(_, (_, count))| *count > 0)
            .map(|(record, (mean, _))| (record, *mean))
            .collect();
        match taken.estimator {
            Estimator::Octaves => {}
            Estimator::MaximumLikelihood => noise.by_maximum_likelihood(&taken.means?),
            Estimator::Slope => noise.by_slope(),
        }
        Some(noise)
    }
}

impl Taken {
    /// Puts the record at hand beside those before it; the next one has a reference of its own.
    fn close_record(&mut self) {
        if let Some(ladder) = self.ladder.take() {
            match &mut self.earlier {
                Some(earlier) => earlier.pool(&ladder),
                None => self.earlier = Some(ladder),
            }
        }
        if let Some(means) = &mut self.means {
            means.next_record();
        }
        let count = std::mem::take(&mut self.count);
        let mut mean = std::mem::take(&mut self.offset);
        for (mean, sum) in mean.iter_mut().zip(std::mem::take(&mut self.sum)) {
            *mean += sum / count.max(1) as f64;
        }
        self.records.push((mean, count));
    }

    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Values(values) => {
                let ladder = self.ladder.get_or_insert_with(|| {
                    let (ladder, reference) = begin(self.kind, values);
                    self.offset = reference;
                    ladder
                });
                ladder.extend(values);
                if let Some(means) = &mut self.means {
                    means.extend(values);
                }
                for value in values {
                    if value.iter().all(|x| x.abs() < 1e6) {
                        for ((sum, x), offset) in self.sum.iter_mut().zip(value).zip(self.offset) {
                            *sum += x - offset;
                        }
                        self.count += 1;
                    }
                }
            }
            Event::Missing(n) => {
                if let Some(ladder) = &mut self.ladder {
                    ladder.missing(n);
                }
                if let Some(means) = &mut self.means {
                    means.missing(n);
                }
            }
            Event::Restart => {
                if let Some(ladder) = &mut self.ladder {
                    ladder.restart();
                }
                if let Some(means) = &mut self.means {
                    means.restart();
                }
            }
        }
    }
}

/// A ladder for values like these, and its reference: their median, and as a bound a thousand times
/// their median absolute deviation. Where that is zero, or values are few, no sensor's range is
/// beyond 1000 rad/s or 10 km/s².
fn begin(kind: SensorKind, values: &[[f64; 3]]) -> (SensorLadder, [f64; 3]) {
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
    let ladder = SensorLadder::with_reference(reference, bound).unwrap_or_default();
    (ladder, reference)
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
    mean: [f64; 3],
) -> SensorNoise {
    let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
    let sampling =
        Sampling { tau0_s, difference: Difference::Allan, windows: WINDOWS as u8, records: 1 };
    let octaves = [0, 1, 2].map(|axis| ladder.octaves(axis));

    // One axis that shows a low-pass filter speaks for all: they share the filter.
    let contradiction = octaves
        .iter()
        .filter_map(|axis| fit_noise(axis, sampling).contradiction)
        .max_by_key(|c| c.octave);
    let from = contradiction.map_or(0, |c| c.octave + 1);
    let fits = octaves.map(|axis| fit_noise_from(&axis, sampling, from));
    // An axis that never changes is no record of noise.
    let live: Vec<_> = octaves.into_iter().filter(|axis| axis[0].variance > 0.0).collect();
    let together = Sampling { records: live.len() as u32, ..sampling };
    let pooled = fit_noise_from(&average_octaves(&live), together, from);

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
        axes: fits
            .map(|f| AxisNoise { noise_density: f.noise_density, random_walk: f.random_walk }),
        pooled: AxisNoise { noise_density: pooled.noise_density, random_walk: pooled.random_walk },
        tau_used_s: pooled.used.map(|(first, last)| (at(first), at(last))),
        contradiction,
        misfit: fits.map(|f| f.misfit),
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

    /// How many times the least noisy axis the noisiest one has of white noise, if that is twice or
    /// more.
    fn spread_of_axes(&self) -> Option<f64> {
        let densities = self.axes.iter().filter_map(|axis| match axis.noise_density {
            Parameter::Observable { value, .. } => Some(value),
            Parameter::NotObservable { .. } => None,
        });
        let (least, most) =
            densities.fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
        (most >= 2.0 * least).then(|| most / least)
    }

    /// What its user should know before believing it.
    pub(super) fn warnings(&self) -> Vec<String> {
        let name = self.kind.name();
        let mut warnings = Vec::new();
        if let Some(contradiction) = self.contradiction {
            let longest = self.deviation.get(contradiction.octave).map_or(0.0, |d| d.tau_s);
            warnings.push(format!(
                "{name}: averaging times up to {longest:.3} s decide nothing: they contradict the \
                 longer ones by {:.0} standard deviations, as a low-pass filter or a vibration makes \
                 them do",
                contradiction.sigmas
            ));
        }
        for (axis, _) in ["x", "y", "z"].iter().zip(self.misfit).filter(|(_, misfit)| *misfit) {
            warnings.push(format!(
                "{name}: axis {axis} has more in it than white noise and a random walk (bias \
                 instability, drift, temperature, motion): take its K for an upper limit, and the \
                 intervals for too narrow"
            ));
        }
        if let Some(times) = self.spread_of_axes() {
            warnings.push(format!(
                "{name}: one axis has {times:.1} times the white noise of another; what is pooled \
                 fits neither: take each axis by itself"
            ));
        }
        if self.rejected > 0 {
            warnings.push(format!(
                "{name}: {} samples are not finite or absurdly large and count as missing",
                self.rejected
            ));
        }
        let stuck = self.deviation.first().map_or([false; 3], |first| {
            first.octaves.map(|octave| octave.differences > 0 && octave.variance == 0.0)
        });
        for (axis, _) in ["x", "y", "z"].iter().zip(stuck).filter(|(_, stuck)| *stuck) {
            warnings.push(format!(
                "{name}: axis {axis} never changes: it is stuck, or finer than the recording's \
                 digits"
            ));
        }
        let Summary { samples, gap_count, missing, duplicates, backward, restarts, .. } =
            self.stamps;
        if gap_count > 0 {
            warnings.push(format!("{name}: samples missing: {missing}, gaps: {gap_count}"));
        }
        if duplicates > samples / 2 {
            warnings.push(format!(
                "{name}: most stamps are the same as the one before: they are too coarse, and the \
                 rate (and with it N and K) may be wrong"
            ));
        } else if duplicates > 0 {
            warnings
                .push(format!("{name}: stamps that are the same as the one before: {duplicates}"));
        }
        if backward > 0 {
            warnings
                .push(format!("{name}: stamps that are earlier than the one before: {backward}"));
        }
        if restarts > 0 {
            warnings.push(format!(
                "{name}: times that the clock was set back or stood still: {restarts}"
            ));
        }
        if let Parameter::NotObservable { upper90, record_at_least_s } = self.pooled.random_walk
            && upper90.is_finite()
        {
            let ns = (record_at_least_s.clamp(0.0, 1e9).round() * 1e9) as u64;
            warnings.push(format!(
                "{name}: the record is too short to show the random walk of the bias; record at \
                 least {}, better for hours",
                display_duration(ns)
            ));
        }
        warnings
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
        let (ladder, reference) = begin(SensorKind::Accelerometer, &values);
        assert!((reference[2] - 9.803).abs() < 1e-9);
        let mut ladder = ladder;
        ladder.extend(&values);
        assert_eq!(ladder.rejected_samples(), 1);
    }
}
