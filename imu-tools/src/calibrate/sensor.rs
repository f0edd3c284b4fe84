//! One sensor's way from samples to noise: stamps to a grid, values into a ladder, a fit.

use serde::{Deserialize, Serialize};

use super::checks::Checker;
use super::envelope::Envelope;
use super::stillness::Stillness;
use super::taken::Taken;
use super::{Estimator, Options, SensorKind, SensorNoise, Stretch, fits};
use crate::recording::{Event, Sample, Timeline};

/// Samples that go through all of the pipeline at once: they stay in the first-level cache meanwhile.
const PIECE: usize = 512;

/// Takes the samples of one sensor as they come.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Pipeline {
    kind: SensorKind,
    #[serde(skip)]
    options: Options,
    timeline: Timeline,
    seen: Seen,
    /// First and latest of the first stamps, and how many.
    first_ns: Option<i64>,
    latest_ns: i64,
    samples: u64,
}

/// What looks at values on the grid, one after the other.
#[derive(Clone, Deserialize, Serialize)]
struct Seen {
    checker: Checker,
    envelope: Option<Envelope>,
    stillness: Stillness,
    taken: Taken,
}

impl Seen {
    fn take(&mut self, event: Event<'_>, period_s: f64) {
        let Self { checker, envelope, stillness, taken } = self;
        let limits = taken.limits(event);
        if let Event::Values(values) = event {
            checker.take(values);
        }
        if let Some(envelope) = envelope {
            envelope.take(event);
        }
        stillness.take(event, period_s, limits, &mut |event| taken.take(event));
    }

    fn next_record(&mut self) {
        let Self { stillness, taken, .. } = self;
        stillness.next_record(&mut |event| taken.take(event));
        taken.close_record();
    }
}

impl Pipeline {
    pub(super) fn new(kind: SensorKind, options: &Options) -> Self {
        let seen = Seen {
            checker: Checker::new(),
            envelope: options.keep_signal.then(Envelope::new),
            stillness: Stillness::new(options.keep_all),
            taken: Taken::new(kind),
        };
        Self {
            kind,
            options: *options,
            timeline: Timeline::new(),
            seen,
            first_ns: None,
            latest_ns: i64::MIN,
            samples: 0,
        }
    }

    /// The same pipeline with other options, as far as they act at the end.
    pub(super) fn with_options(self, options: &Options) -> Self {
        Self { options: *options, ..self }
    }

    /// Takes samples; into how many calls they are divided makes no difference to any bit.
    pub(super) fn push(&mut self, samples: &[Sample]) {
        let mut rest = samples;
        while !rest.is_empty() {
            let room = self.timeline.room();
            let (piece, later) = rest.split_at(room.min(PIECE).min(rest.len()));
            if room < usize::MAX {
                self.note_stamps(piece);
            }
            let period_s = self.rough_period_s();
            self.timeline.push(piece, |event| self.seen.take(event, period_s));
            rest = later;
        }
    }

    /// Notes the stamps of the first samples, which show about how far apart they are.
    fn note_stamps(&mut self, samples: &[Sample]) {
        if let Some(first) = samples.first() {
            self.first_ns.get_or_insert(first.stamp_ns);
        }
        self.latest_ns = samples.iter().fold(self.latest_ns, |last, s| last.max(s.stamp_ns));
        self.samples += samples.len() as u64;
    }

    /// What the sensor does now; `None` as long as too little is known of it.
    pub(super) fn is_moving(&self) -> Option<bool> {
        self.seen.stillness.is_disturbed()
    }

    /// Time between samples, near enough to say how many make a second.
    fn rough_period_s(&self) -> f64 {
        let span = self.latest_ns.saturating_sub(self.first_ns.unwrap_or(self.latest_ns));
        span as f64 * 1e-9 / self.samples as f64
    }

    /// Another record follows: no difference spans the break, all sums add.
    pub(super) fn next_record(&mut self) {
        let period_s = self.rough_period_s();
        self.timeline.next_record(|event| self.seen.take(event, period_s));
        self.seen.next_record();
        self.first_ns = None;
        self.latest_ns = i64::MIN;
        self.samples = 0;
    }

    /// The noise, of a topic yet to be named, or nothing if there was not a sample.
    pub(super) fn finish(self) -> Option<SensorNoise> {
        let period_s = self.rough_period_s();
        let Self { kind, options, timeline, mut seen, .. } = self;
        let stamps = timeline.finish(|event| seen.take(event, period_s));
        let Seen { checker, envelope, stillness, mut taken } = seen;
        let disturbed = stillness.finish(&mut |event| taken.take(event));
        taken.close_record();
        let mean = taken.mean();
        let ladder = taken.earlier?;
        let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
        let seconds = |samples: u64| samples as f64 * tau0_s;
        let means = &taken.means;
        let mut noise = fits::noise(kind, stamps, &ladder, means, mean, &options);
        noise.disturbed = disturbed
            .iter()
            .map(|s| Stretch { from_s: seconds(s.from), to_s: seconds(s.to) })
            .collect();
        noise.checks = checker.finish();
        noise.checks.frozen = disturbed
            .iter()
            .zip(&noise.disturbed)
            .filter(|(stretch, _)| stretch.frozen.contains(&true))
            .map(|(stretch, told)| (stretch.frozen, *told))
            .collect();
        noise.signal = envelope.map_or_else(Vec::new, |envelope| envelope.finish(tau0_s));
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
