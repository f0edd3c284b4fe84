//! Estimators of N and K: errors beside prices.

use serde_json::{Value, json};

use super::{Table, markdown, terminal, with_section};
use crate::scene::display_duration;
use crate::tradeoff::allan::{Accuracy, NOISES, Plan, Row, Scatter, Tradeoff};
use crate::tradeoff::estimators::{Estimator, Gather, Method, Scalar};

/// What its section of a page is marked with.
const MARK: &str = "allan";

/// Name of an estimator, of ordinary words.
#[must_use]
pub fn name(estimator: &Estimator) -> String {
    format!("{}, {}, {}", gather(estimator), scalar(estimator), method(estimator))
}

fn gather(estimator: &Estimator) -> &'static str {
    match estimator.gather {
        Gather::Disjoint => "disjoint",
        Gather::FourWindows => "4 windows",
        Gather::Overlapping => "all windows",
        Gather::BlockMeans => "block means",
    }
}

fn scalar(estimator: &Estimator) -> &'static str {
    match estimator.scalar {
        Scalar::F32 => "f32",
        Scalar::F64 => "f64",
    }
}

fn method(estimator: &Estimator) -> &'static str {
    match estimator.method {
        Method::Fit => "fit",
        Method::MaximumLikelihood => "ML",
        Method::Slope => "slope",
    }
}

/// Columns that say which estimator it is.
const NAMES: usize = 3;

/// The price of each estimator, and its errors for each noise.
fn tables(tradeoff: &Tradeoff) -> Vec<Table> {
    let start = |head: &[&str]| {
        let names = ["gathered", "in", "read by"];
        vec![names.iter().chain(head).map(|name| (*name).to_owned()).collect()]
    };
    let named = |estimator: &Estimator, cells: Vec<String>| {
        let names = [gather(estimator), scalar(estimator), method(estimator)];
        names.into_iter().map(str::to_owned).chain(cells).collect()
    };
    let mut prices = start(&["ns/value", "× sum", "ms at end", "ns in all", "state"]);
    prices.extend(tradeoff.rows.iter().map(|row| {
        let Row { estimator, cost, .. } = row;
        let cells = vec![
            format!("{:.2}", cost.ns_per_value),
            format!("{:.1}", cost.ns_per_value / tradeoff.sum_ns),
            format!("{:.3}", cost.end_ms),
            format!("{:.1}", row.price_ns(&tradeoff.plan)),
            bytes(cost.state_bytes),
        ];
        named(estimator, cells)
    }));
    let mut tables = vec![Table { title: "Price".into(), names: NAMES, rows: prices }];
    for (k, noise) in NOISES.iter().enumerate() {
        let limit = tradeoff.plan.limit_of_random_walk(noise);
        let mut errors = start(&["K", "× limit", "median", "in 90 %", "none", "N"]);
        errors.extend(tradeoff.rows.iter().filter_map(|Row { estimator, accuracy, .. }| {
            let Accuracy { noise_density, random_walk } = accuracy.get(k)?;
            let cells = vec![
                percent(random_walk),
                format!("{:.2}", random_walk.rms / limit),
                format!("{:+.1} %", 100.0 * random_walk.median),
                random_walk.coverage.map_or("-".into(), |part| format!("{:.0} %", 100.0 * part)),
                format!("{:.0} %", 100.0 * random_walk.without),
                percent(noise_density),
            ];
            Some(named(estimator, cells))
        }));
        let period = noise.noise_density / noise.random_walk;
        let title = format!("Errors where N/K = {period:.0} s");
        tables.push(Table { title, names: NAMES, rows: errors });
    }
    tables
}

fn percent(scatter: &Scatter) -> String {
    if !scatter.rms.is_finite() {
        return "-".into();
    }
    let digits = if scatter.rms < 0.01 { 3 } else { 1 };
    format!("{:.digits$} ± {:.digits$} %", 100.0 * scatter.rms, 100.0 * scatter.rms_sd)
}

fn bytes(bytes: usize) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// The sentences before a table.
fn about(tradeoff: &Tradeoff) -> String {
    let plan = &tradeoff.plan;
    let limits = NOISES.map(|noise| 100.0 * plan.limit_of_random_walk(&noise));
    format!(
        "{} records of three axes at rest, {} at {} Hz, of each of two noises. No estimator can know K \
         better than {:.1} % and {:.1} %, nor N better than {:.3} %. A plain sum of the same values takes \
         {:.2} ns a value.",
        plan.records,
        duration(plan),
        plan.rate_hz,
        limits[0],
        limits[1],
        100.0 * plan.limit_of_noise_density(),
        tradeoff.sum_ns
    )
}

/// Length of a record, in words that `--duration` takes.
fn duration(plan: &Plan) -> String {
    display_duration((plan.duration_s * 1e9).round() as u64)
}

const COLUMNS: &str = "\
K and N: root mean square of the relative error, and how far that itself scatters; where no K is read it \
counts as 0. × limit: over the least that is possible. in 90 %: how often the 90 % interval, or the bound \
where no K is read, holds the true K (a slope has none). none: records from which no K was read. ns/value: \
as samples come (all windows: once they are all there), × sum: over a plain sum. ms at end: once for each \
axis. ns in all: both, for each value of such a record. state: memory for three axes.";

/// The tables on a terminal.
#[must_use]
pub fn table(tradeoff: &Tradeoff) -> String {
    format!("{}\n{}\n{COLUMNS}\n", about(tradeoff), terminal(&tables(tradeoff)))
}

/// Everything, for programs; what is no number is null.
#[must_use]
pub fn json(tradeoff: &Tradeoff) -> Value {
    let scatter = |s: &Scatter| {
        json!({
            "rms": s.rms, "rms_sd": s.rms_sd, "median": s.median, "coverage90": s.coverage,
            "without": s.without,
        })
    };
    let rows: Vec<_> = tradeoff
        .rows
        .iter()
        .map(|row| {
            let accuracy = row.accuracy.iter().map(|accuracy| {
                json!({
                    "noise_density": scatter(&accuracy.noise_density),
                    "random_walk": scatter(&accuracy.random_walk),
                })
            });
            json!({
                "gathered": gather(&row.estimator),
                "scalar": scalar(&row.estimator),
                "method": method(&row.estimator),
                "ns_per_value": row.cost.ns_per_value,
                "ns_per_value_in_all": row.price_ns(&tradeoff.plan),
                "end_ms": row.cost.end_ms,
                "state_bytes": row.cost.state_bytes,
                "accuracy": accuracy.collect::<Vec<_>>(),
            })
        })
        .collect();
    let plan = &tradeoff.plan;
    let noises = NOISES.map(|noise| {
        json!({
            "noise_density": noise.noise_density,
            "random_walk": noise.random_walk,
            "limit_of_random_walk": plan.limit_of_random_walk(&noise),
            "limit_of_noise_density": plan.limit_of_noise_density(),
        })
    });
    json!({
        "duration_s": plan.duration_s,
        "rate_hz": plan.rate_hz,
        "records": plan.records,
        "seed": plan.seed,
        "sum_ns_per_value": tradeoff.sum_ns,
        "noises": noises,
        "estimators": rows,
    })
}

/// The page with this section in the place of the one it had, or behind all others; `picture` is the
/// name of the plot's file.
#[must_use]
pub fn page(before: Option<&str>, tradeoff: &Tradeoff, picture: &str) -> String {
    with_section(before, MARK, &section(tradeoff, picture))
}

fn section(tradeoff: &Tradeoff, picture: &str) -> String {
    let plan = &tradeoff.plan;
    format!(
        "## Estimators of N and K\n\n`imu tradeoff allan --records {} --duration \"{}\" --rate {} \
         --seed {} -o FOLDER` wrote this section.\n\n{}\n\n![error of K over price]({picture})\n\n{}{COLUMNS}",
        plan.records,
        duration(plan),
        plan.rate_hz,
        plan.seed,
        about(tradeoff),
        markdown(&tables(tradeoff))
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::allan::measure;

    /// A line for each estimator, in all forms, and a section that takes its own place.
    #[test]
    fn every_estimator_is_in_every_form() {
        let plan = Plan { duration_s: 1000.0, rate_hz: 4.0, records: 2, seed: 3 };
        let tradeoff = measure(&plan, |_| {}).unwrap();
        assert_eq!(table(&tradeoff).lines().filter(|line| line.contains(" f64 ")).count(), 3 * 7);
        assert_eq!(json(&tradeoff)["estimators"].as_array().unwrap().len(), 11);
        let first = page(None, &tradeoff, "a.svg");
        assert!(first.contains("](a.svg)"));
        assert_eq!(page(Some(&first), &tradeoff, "a.svg"), first);
    }
}
