//! Error over price: of estimators of K, one chart for each noise; of integration rules, one for each motion.

use super::chart::Chart;
use super::scale::Scale;
use super::{Figure, WIDTH};
use crate::report::tradeoff::allan::name;
use crate::tradeoff::allan::{NOISES, Tradeoff};
use crate::tradeoff::estimators::Method;
use crate::tradeoff::rules::follow::{Carrier, RULES};
use crate::tradeoff::rules::motion::Motion;
use crate::tradeoff::rules::{self, Way};

const HEIGHT: f64 = 400.0;

/// A mark for each estimator: across its price, up its error of K. Slopes, whose errors are several times
/// as large, are in the table only.
#[must_use]
pub fn tradeoff(tradeoff: &Tradeoff) -> Figure {
    let description =
        "Error of the random walk over nanoseconds a value, of all estimators but slopes";
    let charts = NOISES.iter().enumerate().map(|(k, noise)| {
        let limit = tradeoff.plan.limit_of_random_walk(noise);
        let points = tradeoff.rows.iter().filter_map(|row| {
            let scatter = row.accuracy.get(k)?.random_walk;
            let point = (row.price_ns(&tradeoff.plan), 100.0 * scatter.rms);
            Some((row, point, 100.0 * scatter.rms_sd))
        });
        let shown = || points.clone().filter(|(row, ..)| row.estimator.method != Method::Slope);
        let ends = shown().flat_map(|(_, (_, rms), sd)| [rms - sd, rms + sd]);
        let mut chart = Chart::new(
            (0.0, k as f64 * HEIGHT),
            (WIDTH, HEIGHT),
            Scale::decades(points.clone().flat_map(|(_, (ns, _), _)| [ns, 3.0 * ns])),
            Scale::around(ends.chain([100.0 * limit])),
        );
        let (first, last) = (1e-3, 1e6);
        chart.line("line fit", &[(first, 100.0 * limit), (last, 100.0 * limit)]);
        for (place, (row, point, sd)) in shown().enumerate() {
            chart.bar("line term", point.0, point.1 - sd, point.1 + sd);
            chart.mark("mark", point, place % 2 == 1, &name(&row.estimator));
        }
        chart.name("line fit", "limit √(2N/KT)");
        let period = noise.noise_density / noise.random_walk;
        chart.finish(
            &format!("tradeoff-{k}"),
            &format!("rms error of K where N/K = {period:.0} s"),
            "price in all, ns a value",
            "rms error of K, %",
        )
    });
    Figure::new(description.into(), charts, HEIGHT)
}

/// Classes of the rules, in their order.
const LINES: [&str; RULES.len()] =
    ["line rule0", "line rule1", "line rule2", "line rule3", "line rule4", "line rule5"];

/// Error of attitude over price in `f64`, a line for each rule and a dot for each rate; and the cheapest way to each
/// accuracy by name.
#[must_use]
pub fn rules(tradeoff: &rules::Tradeoff) -> Figure {
    let description = "Largest error of attitude over price, of all rules at all rates, by motion";
    let motions = [Motion::Ellipse, Motion::Gait, Motion::Coning, Motion::Spin];
    let charts = motions.into_iter().enumerate().map(|(k, motion)| {
        let ways = RULES.map(|rule| {
            let of = |run: &&rules::Clean| {
                (run.motion, run.rule, run.carrier) == (motion, rule, Carrier::F64)
            };
            let runs = tradeoff.clean.iter().filter(of);
            runs.filter_map(|run| tradeoff.way(run)).collect::<Vec<Way>>()
        });
        let point = |way: &Way| (way.ns_per_second / 1e3, way.run.errors.attitude_deg.max(1e-13));
        let points = || ways.iter().flatten().map(point);
        let mut chart = Chart::new(
            (0.0, k as f64 * HEIGHT),
            (WIDTH, HEIGHT),
            Scale::decades(points().flat_map(|(price, _)| [price, 1.3 * price])),
            Scale::decades(points().map(|(_, error)| error)),
        );
        for ((ways, class), rule) in ways.iter().zip(LINES).zip(RULES) {
            let line: Vec<_> = ways.iter().map(point).collect();
            chart.line(class, &line);
            chart.dots("mark", &line);
            chart.name(class, rule.name());
        }
        for wanted in [1.0, 1e-2, 1e-4, 1e-6, 1e-8] {
            if let Some(way) = tradeoff.cheapest(motion, wanted, &[Carrier::F64]) {
                let name = format!("{wanted:e}°: {}, {} Hz", way.run.rule.name(), way.run.rate);
                chart.mark("mark", point(&way), true, &name);
            }
        }
        chart.finish(
            &format!("rules-{k}"),
            motion.name(),
            "price, µs of computing for each second of motion",
            "largest error of attitude, °",
        )
    });
    Figure::new(description.into(), charts, HEIGHT)
}
