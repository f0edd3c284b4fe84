//! Integration rules: errors beside prices, and which to use.

use serde_json::{Value, json};

use super::{Table, cells, markdown, number, terminal, with_section};
use crate::tradeoff::rules::follow::{CARRIERS, Carrier, Errors, RULES, Rule};
use crate::tradeoff::rules::motion::{MOTIONS, Motion};
use crate::tradeoff::rules::{Clean, GRADES, Noisy, Price, Tradeoff, Way};

/// What its section of a page is marked with.
const MARK: &str = "rules";

/// Accuracies that a user may want of the attitude over a motion, °.
const WANTED_DEG: [f64; 6] = [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-6];

fn rates(tradeoff: &Tradeoff) -> impl Iterator<Item = String> {
    tradeoff.plan.rates.iter().map(|rate| format!("{rate} Hz"))
}

/// One error of a run.
type Of = fn(&Errors) -> f64;

/// Errors of a rule in some numbers on a motion, over the rates.
fn row(tradeoff: &Tradeoff, motion: Motion, rule: Rule, carrier: Carrier, of: Of) -> Vec<String> {
    let run = |rate| {
        tradeoff.clean.iter().find(move |run: &&Clean| {
            (run.motion, run.rule, run.carrier, run.rate) == (motion, rule, carrier, rate)
        })
    };
    let error = |&rate| run(rate).map_or("-".into(), |run| number(of(&run.errors)));
    tradeoff.plan.rates.iter().map(error).collect()
}

fn tables(tradeoff: &Tradeoff) -> Vec<Table> {
    let mut tables = vec![advice(tradeoff), prices(tradeoff)];
    for motion in MOTIONS.into_iter().filter(|motion| *motion != Motion::Rest) {
        for (what, of) in ERRORS {
            let mut rows = vec![cells(&["rule"], rates(tradeoff))];
            for rule in RULES {
                let numbers = row(tradeoff, motion, rule, Carrier::F64, of);
                rows.push(cells(&[rule.name()], numbers.into_iter()));
            }
            let title = format!("{}, {what}", motion.name());
            tables.push(Table { title, names: 1, rows });
        }
    }
    let shown = [(Motion::Ellipse, Rule::ThreeSample), (Motion::Rest, Rule::Midpoint)];
    for (motion, rule) in shown {
        for (what, of) in ERRORS {
            let mut rows = vec![cells(&["numbers"], rates(tradeoff))];
            for carrier in CARRIERS {
                let numbers = row(tradeoff, motion, rule, carrier, of);
                rows.push(cells(&[carrier.name()], numbers.into_iter()));
            }
            let title = format!("{}, {}, {what}", motion.name(), rule.name());
            tables.push(Table { title, names: 1, rows });
        }
    }
    tables.extend(noisy(tradeoff));
    tables
}

const ERRORS: [(&str, Of); 2] = [
    ("largest error of attitude, °", |errors| errors.attitude_deg),
    ("largest error of position, m", |errors| errors.position),
];

/// Which rule to use for a wanted accuracy.
fn advice(tradeoff: &Tradeoff) -> Table {
    let motions = [Motion::Ellipse, Motion::Gait, Motion::Coning, Motion::Spin];
    let names = motions.map(|motion| motion.name().to_owned());
    let mut rows = vec![cells(&["attitude within"], names.into_iter())];
    for wanted in WANTED_DEG {
        let ways = motions.map(|motion| match tradeoff.cheapest(motion, wanted, &CARRIERS) {
            Some(Way { run, ns_per_second }) => format!(
                "{}, {}, {} Hz ({} µs)",
                run.rule.name(),
                run.carrier.name(),
                run.rate,
                number(ns_per_second / 1e3)
            ),
            None => "none".into(),
        });
        rows.push(cells(&[&format!("{wanted} °")], ways.into_iter()));
    }
    let title = "What to use: the cheapest on samples, and what it takes for each second".into();
    Table { title, names: 5, rows }
}

fn prices(tradeoff: &Tradeoff) -> Table {
    let mut rows = vec![cells(&["ns a step"], CARRIERS.iter().map(|c| c.name().to_owned()))];
    for rule in RULES {
        let numbers = CARRIERS.iter().map(|&carrier| {
            let price = tradeoff.prices.iter().find(|p| (p.rule, p.carrier) == (rule, carrier));
            price.map_or("-".into(), |Price { ns, .. }| {
                format!("{ns:.1} ({:.2} ×)", ns / tradeoff.textbook_ns)
            })
        });
        rows.push(cells(&[rule.name()], numbers));
    }
    Table {
        title: "Price of a step, and over that of the textbook’s midpoint".into(),
        names: 1,
        rows,
    }
}

/// With noise, a table for each grade.
fn noisy(tradeoff: &Tradeoff) -> impl Iterator<Item = Table> {
    let plan = &tradeoff.plan;
    let grades = GRADES.iter().filter(|_| !plan.noisy_rates.is_empty());
    grades.map(|grade| {
        let columns = MOTIONS.iter().flat_map(|motion| {
            plan.noisy_rates.iter().map(move |rate| format!("{} {rate} Hz", motion.name()))
        });
        let mut rows = vec![cells(&["rule"], columns)];
        for rule in RULES.into_iter().filter(|rule| !rule.takes_increments()) {
            let of = tradeoff.noisy.iter().filter(|row| row.rule == rule && row.grade == *grade);
            let numbers = of.map(|Noisy { rms, .. }| {
                format!("{}° {} m", number(rms.attitude_deg), number(rms.position))
            });
            rows.push(cells(&[rule.name()], numbers));
        }
        let title = format!("With white noise, {}: rms at the end", grade.name);
        Table { title, names: 1, rows }
    })
}

/// The sentences before the tables.
fn about(tradeoff: &Tradeoff) -> String {
    let plan = &tradeoff.plan;
    let mut text = format!(
        "Dead reckoning from the true beginning, on a flat world, without noise: ellipse (30 × 40 m every 20 s), gait (a \
         hand-held walk with tremor), coning (1° at 25 Hz) and rest for 60 s, spin (2000 °/s, shaken by 5 g at 80 Hz) for \
         10 s. Samples are of instants; the two rules of increments are given exact ones at the same rate. A step of \
         the textbook’s midpoint in f64 takes {:.1} ns.",
        tradeoff.textbook_ns
    );
    if let Some(row) = tradeoff.noisy.first() {
        text.push_str(&format!(
            " With noise: root mean squares over {} records, which scatter by ±{:.0} % of themselves.",
            plan.records,
            100.0 * row.scatter
        ));
    }
    text
}

const COLUMNS: &str = "\
A rule’s order shows in how its error falls with the rate. Below about ten samples for each turn of the fastest \
motion (coning and spin at 100 and 200 Hz) no rule helps: what is not sampled is not known. coning+sculling halves \
midpoint’s error of attitude where the axis of rotation moves, at its price; the position of smooth motion gains \
nothing. Three samples are worth their price wherever the motion is smooth between samples and the noise is small. \
Increments are better than samples where a sensor gives them. Where noise decides, as of consumer sensors on smooth \
motion, all rules but Euler’s are equal: take the cheapest.";

/// The tables on a terminal.
#[must_use]
pub fn table(tradeoff: &Tradeoff) -> String {
    format!("{}\n{}\n{COLUMNS}\n", about(tradeoff), terminal(&tables(tradeoff)))
}

/// The page with this section in the place of the one it had, or behind all others; `picture` is the name of the
/// plot's file.
#[must_use]
pub fn page(before: Option<&str>, tradeoff: &Tradeoff, picture: &str) -> String {
    let plan = &tradeoff.plan;
    let list = |rates: &[u32]| rates.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
    let noisy = match plan.noisy_rates.as_slice() {
        [] => String::new(),
        rates => format!(" --noisy-rates {}", list(rates)),
    };
    let section = format!(
        "## Integration rules\n\n`imu tradeoff rules --rates {}{noisy} --records {} --seed {} -o FOLDER` wrote this \
         section.\n\n{}\n\n![error of attitude over price]({picture})\n\n{}{COLUMNS}",
        list(&plan.rates),
        plan.records,
        plan.seed,
        about(tradeoff),
        markdown(&tables(tradeoff))
    );
    with_section(before, MARK, &section)
}

/// Everything, for programs.
#[must_use]
pub fn json(tradeoff: &Tradeoff) -> Value {
    let errors = |errors: &Errors| {
        json!({
            "attitude_deg": errors.attitude_deg,
            "velocity_mps": errors.velocity,
            "position_m": errors.position,
        })
    };
    let clean = tradeoff.clean.iter().map(|run| {
        json!({
            "motion": run.motion.name(),
            "rule": run.rule.name(),
            "numbers": run.carrier.name(),
            "rate_hz": run.rate,
            "largest": errors(&run.errors),
            "ns_per_second": tradeoff.way(run).map(|way| way.ns_per_second),
        })
    });
    let noisy = tradeoff.noisy.iter().map(|row| {
        json!({
            "motion": row.motion.name(),
            "rule": row.rule.name(),
            "rate_hz": row.rate,
            "gyroscope_noise_density": row.grade.gyroscope,
            "accelerometer_noise_density": row.grade.accelerometer,
            "rms_at_the_end": errors(&row.rms),
            "scatter": row.scatter,
        })
    });
    let prices = tradeoff.prices.iter().map(|price| {
        json!({
            "rule": price.rule.name(), "numbers": price.carrier.name(), "ns_per_step": price.ns,
            "over_textbook": price.ns / tradeoff.textbook_ns,
        })
    });
    let plan = &tradeoff.plan;
    json!({
        "rates_hz": plan.rates,
        "noisy_rates_hz": plan.noisy_rates,
        "records": plan.records,
        "seed": plan.seed,
        "textbook_ns_per_step": tradeoff.textbook_ns,
        "clean": clean.collect::<Vec<_>>(),
        "noisy": noisy.collect::<Vec<_>>(),
        "prices": prices.collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::rules::{Plan, measure};

    #[test]
    fn every_run_is_in_every_form() {
        let plan = Plan { rates: vec![50, 100], noisy_rates: vec![50], records: 2, seed: 1 };
        let tradeoff = measure(&plan, |_| {}).unwrap();
        let text = table(&tradeoff);
        assert!(text.contains("ellipse, largest error of attitude, °"), "{text}");
        assert_eq!(text.matches("With white noise").count(), 3);
        let json = json(&tradeoff);
        assert_eq!(json["clean"].as_array().unwrap().len(), 5 * 2 * 4 * 6);
        assert_eq!(json["noisy"].as_array().unwrap().len(), 5 * 3 * 4);
        let first = page(None, &tradeoff, "a.svg");
        assert_eq!(page(Some(&first), &tradeoff, "a.svg"), first);
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
