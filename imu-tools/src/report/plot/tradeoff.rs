//! Error of K over price, one chart for each noise.

use super::chart::Chart;
use super::scale::Scale;
use super::{Figure, WIDTH};
use crate::report::tradeoff::name;
use crate::tradeoff::allan::{NOISES, Tradeoff};
use crate::tradeoff::estimators::Method;

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
