//! What to tell of a recording that was integrated, or could not be: a sentence each.

use super::pairs::HOLE;
use super::rest;
use super::run::Run;
use super::{GravityFrom, Kind, KnownBias, Start};
use crate::calibrate::gravity;
use crate::recording::SampleKind;
use crate::scene::display_duration;

/// A hole, and what was done about it.
pub(super) fn hole(at_s: f64, long_s: f64, crossed: bool, has_truth: bool) -> String {
    let long = display_duration((long_s * 1e9) as u64);
    let what = format!("{long} are missing after {at_s:.3} s, which dead reckoning cannot cross");
    match (crossed, has_truth) {
        (true, _) => {
            format!("{what}: it begins anew behind them in the state that the truth tells")
        }
        (false, true) => format!("{what}, and the truth knows nothing of their end: it ends there"),
        (false, false) => {
            format!("{what}: it ends there; integrate the rest by itself, with --from")
        }
    }
}

/// What is wrong with samples that are said to be of one kind, and of which the recording tells another.
pub(super) fn other_kind(path: &str, said: Kind, told: SampleKind) -> Option<String> {
    let (told, samples) = match told {
        SampleKind::Instantaneous => (Kind::Instantaneous, "instantaneous"),
        // A reader has divided increments by their time.
        SampleKind::Mean | SampleKind::Increments => (Kind::Mean, "means"),
    };
    (told != said).then(|| {
        format!(
            "the samples of {path} are said to be {said}, and by its header they are {samples}: take --samples \
             {told}, or --columns if the header is wrong"
        )
    })
}

/// Why nothing was integrated.
pub(super) fn nothing(run: &Run<'_>) -> String {
    let path = run.path;
    let (rates, forces) = run.pairs.counts();
    if rates == 0 || forces == 0 {
        let what = match (rates, forces) {
            (0, 0) => "no sample",
            (0, _) => "no sample of a gyroscope",
            _ => "no sample of an accelerometer",
        };
        return format!(
            "{path} holds {what} that can be used, and dead reckoning needs both sensors{}: see what \
             it holds with imu info",
            left_out(run).map(|sentence| format!(" ({sentence})")).unwrap_or_default()
        );
    }
    if run.begun.is_none() && run.too_early > 0 {
        let span = run.truth.as_ref().and_then(|truth| truth.span_ns()).zip(run.first_ns);
        let apart = span.map_or(String::new(), |((first, last), start)| {
            let s = |ns: i64| ns.saturating_sub(start) as f64 * 1e-9;
            match (s(first), s(last)) {
                (first, _) if first > 0.0 => {
                    format!(": it begins {first:.3} s after its first sample")
                }
                (_, last) if last < 0.0 => {
                    format!(": it ends {:.3} s before its first sample", -last)
                }
                _ => ": its poses are more than 0.5 s apart there".into(),
            }
        });
        return format!(
            "the truth {} knows no state at any sample of {path}{apart}; are their clocks the same? (--no-truth goes \
             without)",
            run.truth_name.as_deref().unwrap_or_default()
        );
    }
    if rates == 1 || run.pairs.period_ns().is_none() {
        return format!(
            "{path} holds samples of one instant only, so there is no step to integrate: see its \
             stamps with imu info"
        );
    }
    if run.begun.is_none() {
        return format!("no sample of {path} lies between --from and --to");
    }
    let why = run.warnings.first().map(|why| format!(": {why}")).unwrap_or_default();
    format!("{path} has no two samples near enough for a step{why}")
}

fn left_out(run: &Run<'_>) -> Option<String> {
    let left = run.pairs.left_out();
    let mut parts = Vec::new();
    if left.impossible > 0 {
        parts.push(format!("{} are not numbers or beyond any sensor", left.impossible));
    }
    if left.doubled > 0 {
        parts.push(format!("{} have the stamp of the one before", left.doubled));
    }
    if left.backward > 0 {
        parts.push(format!(
            "{} are stamped before the one before, by up to {}",
            left.backward,
            display_duration(left.furthest_back_ns.unsigned_abs())
        ));
    }
    (!parts.is_empty()).then(|| format!("left out, counted of both sensors: {}", parts.join("; ")))
}

impl Run<'_> {
    /// Collects what there is to tell at the end.
    pub(super) fn remark(&mut self) {
        self.warnings.extend(left_out(self));
        if self.pairs.alone > 0 {
            self.remarks.push(format!(
                "{} samples of the gyroscope have none of the accelerometer around them and are not used",
                self.pairs.alone
            ));
        }
        if self.pairs.interpolated > 0 {
            self.remarks.push(format!(
                "the accelerometer is interpolated to {} samples of the gyroscope, whose stamps are others",
                self.pairs.interpolated
            ));
        }
        if self.bridged > 0 {
            self.remarks.push(format!(
                "{} steps are longer than usual (up to {HOLE} periods): the rule bridges what is missing",
                self.bridged
            ));
        }
        if self.too_early > 0 {
            self.remarks.push(format!(
                "the first {} samples are before the truth begins, and are not used",
                self.too_early
            ));
        }
        if let Some(left) = self.truth.as_ref().map(|truth| truth.left_out).filter(|n| *n > 0) {
            self.warnings.push(format!(
                "{left} poses of the truth are no numbers or not after the one before: left out"
            ));
        }
        self.remark_on_start();
        let compared = self.lanes.iter().any(|lane| lane.sums.errors().is_some());
        if self.truth.is_none() {
            self.remarks.push(match &self.unchosen {
                Some(list) => format!(
                    "{} has several topics of poses: {list}; compare with one by --truth-topic TOPIC",
                    self.path
                ),
                None => "there is no truth to compare with: name one with --truth FILE (TUM, EuRoC or that of \
                         imu simulate)"
                    .into(),
            });
        } else if !compared {
            self.warnings.push("the truth has no pose after the start: nothing is compared".into());
        }
    }

    fn remark_on_start(&mut self) {
        let Some(begun) = self.begun else { return };
        if begun.differenced {
            self.remarks.push(
                "the truth has no velocity: that of the start comes from its positions within 0.1 s".into(),
            );
        }
        if self.options.bias == Some(KnownBias::Truth) && begun.bias == Default::default() {
            self.warnings
                .push("the truth has no biases, or they are zero: none is taken off".into());
        }
        if let Some(force) = self.force_at_rest {
            let heading = rest::heading(&begun.motion.attitude_wb).to_degrees();
            let from = if self.truth.is_some() { "the truth's" } else { "unknown, taken as" };
            let length = match begun.gravity_from {
                GravityFrom::Rest => "whose length is taken for gravity".into(),
                _ => format!("whose length is {force:.4} m/s²"),
            };
            self.remarks.push(format!(
                "at rest for {} s: level by the mean specific force, {length}; heading {from} {heading:.1}°",
                self.options.rest_s
            ));
        }
        if begun.from == Start::Truth && !self.options.unit_is_given {
            let felt = self.felt / self.steps as f64;
            if let gravity::Verdict::OtherUnit(why) = gravity::check([0.0, 0.0, felt]) {
                self.warnings.push(why);
            }
        }
    }
}
