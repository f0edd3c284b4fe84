//! Splines: errors by spacing, orders and prices, and which to use.

use serde_json::{Value, json};

use super::{Table, cells, markdown, number, terminal, with_section};
use crate::tradeoff::rules::motion::Motion;
use crate::tradeoff::spline::{
    CONTROLS, Control, Errors, FORMS, Form, NUMBERS, Numbers, Price, Run, Tradeoff,
};

/// What its section of a page is marked with.
const MARK: &str = "spline";

/// One error of a curve.
type Of = fn(&Errors) -> f64;

/// What is compared, and what a user may want of it.
const ERRORS: [(&str, Of, &str, [f64; 4]); 4] = [
    ("rotation", |errors| errors.rotation, "rad", [1e-2, 1e-4, 1e-6, 1e-8]),
    ("angular rate", |errors| errors.angular_rate, "rad/s", [0.1, 1e-2, 1e-3, 1e-5]),
    ("position", |errors| errors.position, "m", [1e-2, 1e-4, 1e-6, 1e-8]),
    ("acceleration", |errors| errors.acceleration, "m/s²", [1.0, 0.1, 1e-2, 1e-3]),
];

/// Forms with the control points that there are for them, in the order of tables.
fn curves() -> impl Iterator<Item = (Form, Control)> {
    let of = |form| CONTROLS.into_iter().map(move |control| (form, control));
    FORMS.into_iter().flat_map(of).filter(|(form, control)| control.is_for(*form))
}

fn spacings(tradeoff: &Tradeoff) -> impl Iterator<Item = String> {
    tradeoff.plan.spacings_s.iter().map(|spacing| format!("{spacing} s"))
}

fn error(run: &Run, of: Of) -> String {
    run.errors.as_ref().map_or("-".into(), |errors| number(of(errors)))
}

fn tables(tradeoff: &Tradeoff) -> Vec<Table> {
    let mut tables = vec![advice(tradeoff), prices(tradeoff)];
    for &motion in &tradeoff.plan.motions {
        tables.extend(ERRORS.iter().map(|(what, of, unit, _)| {
            let columns = spacings(tradeoff).chain(["order".into()]);
            let mut rows = vec![cells(&["curve", "control points"], columns)];
            for (form, control) in curves() {
                let errors = tradeoff.of(motion, form, control, Numbers::F64);
                let order = tradeoff.order(motion, form, control, *of);
                let order = order.map_or("-".into(), |order| format!("{order:.2}"));
                let numbers = errors.map(|run| error(run, *of)).chain([order]);
                rows.push(cells(&[form.name(), control.name()], numbers));
            }
            Table {
                title: format!("{}, {what}: largest error, {unit}", motion.name()),
                names: 2,
                rows,
            }
        }));
    }
    if let Some(&motion) = tradeoff.plan.motions.first() {
        tables.extend(
            ERRORS.iter().map(|(what, of, unit, _)| in_numbers(tradeoff, motion, what, *of, unit)),
        );
    }
    tables
}

/// What single precision leaves of the symmetric form, interpolated.
fn in_numbers(tradeoff: &Tradeoff, motion: Motion, what: &str, of: Of, unit: &str) -> Table {
    let mut rows = vec![cells(&["numbers"], spacings(tradeoff))];
    for numbers in NUMBERS {
        let runs = tradeoff.of(motion, Form::Symmetric, Control::Interpolation, numbers);
        rows.push(cells(&[numbers.name()], runs.map(|run| error(run, of))));
    }
    let title =
        format!("{}, symmetric, interpolation, {what}: largest error, {unit}", motion.name());
    Table { title, names: 1, rows }
}

/// Which curve to use for a wanted accuracy.
fn advice(tradeoff: &Tradeoff) -> Table {
    let motions = &tradeoff.plan.motions;
    let mut rows = vec![cells(&["within"], motions.iter().map(|m| m.name().to_owned()))];
    for (what, of, unit, wanted) in ERRORS {
        for wanted in wanted {
            let ways = motions.iter().map(|&motion| match tradeoff.best(motion, of, wanted) {
                Some((run, ns)) => format!(
                    "{} s: {}, {}, {} ({ns:.0} ns)",
                    run.spacing_s,
                    run.form.name(),
                    run.control.name(),
                    run.numbers.name(),
                ),
                None => "none".into(),
            });
            let wanted = if wanted < 0.01 { format!("{wanted:e}") } else { wanted.to_string() };
            rows.push(cells(&[&format!("{what} {wanted} {unit}")], ways));
        }
    }
    let title =
        "What to use: the widest spacing that will do, and of such curves the cheapest".into();
    Table { title, names: 1 + motions.len(), rows }
}

fn prices(tradeoff: &Tradeoff) -> Table {
    let mut rows = vec![cells(&["ns a full state"], NUMBERS.iter().map(|n| n.name().to_owned()))];
    let price = |form, numbers| {
        tradeoff.prices.iter().find(|p| (p.form, p.numbers) == (form, numbers)).map(|p| p.ns)
    };
    for form in FORMS {
        let numbers = NUMBERS.iter().map(|&numbers| {
            match (price(form, numbers), price(Form::Plain, numbers)) {
                (Some(ns), Some(plain)) => format!("{ns:.0} ({:.2} ×)", ns / plain),
                _ => "-".into(),
            }
        });
        rows.push(cells(&[form.name()], numbers));
    }
    Table { title: "Price of a full state, and over that of the plain form".into(), names: 1, rows }
}

/// The sentences before the tables.
fn about(tradeoff: &Tradeoff) -> String {
    let name = |motion: &Motion| format!("{} ({} s)", motion.name(), motion.duration_s());
    let motions: Vec<_> = tradeoff.plan.motions.iter().map(name).collect();
    format!(
        "Curves made of exact poses of a motion, one every so many seconds, and the largest error between them: {}, as \
         integration rules are measured on. Plain is positions beside attitudes by the cumulative product, symmetric the \
         same with attitudes of the time-symmetric form, SE(3) couples both along screws: its control points are never \
         interpolated, its quasi-interpolant is that of its own logarithm. The order is that of the two closest \
         spacings, in f64. A full state is pose, v, ω, a and α; cached knots hold logarithms and differences, formed in \
         f64. In plots, plain and symmetric are interpolated where nothing else is said, and SE(3) is its \
         quasi-interpolant.",
        motions.join(", ")
    )
}

const COLUMNS: &str = "\
Where knots are close enough to follow a motion, halving the spacing divides the error of rotation by 8 with the plain \
form and by 16 with the symmetric one, that of ω by 4 and by 8; position and acceleration (16 and 4) are the same in \
both. Take the symmetric form where attitude or ω decides, the plain one where acceleration does: it is of second order \
in both, and the first to ask for closer knots. Interpolation costs no more to evaluate than other control points, and is \
several times closer in pose; where knots are too far apart for the motion its acceleration is worse, most of all at both ends, where the \
quasi-interpolant has a pose beyond. Poses as control points are of second order in everything: never take them. SE(3) is dearer, \
and where knots are close the rotation’s lost order shows in its position and acceleration, too. Cache knots that do not \
move; in f32 always: of poses rounded to f32 rates and accelerations are lost as knots come closer.";

/// The tables on a terminal.
#[must_use]
pub fn table(tradeoff: &Tradeoff) -> String {
    format!("{}\n{}\n{COLUMNS}\n", about(tradeoff), terminal(&tables(tradeoff)))
}

/// The page with this section in the place of the one it had, or behind all others; `pictures` are the names of the
/// files of the plots, orders first.
#[must_use]
pub fn page(before: Option<&str>, tradeoff: &Tradeoff, [orders, price]: [&str; 2]) -> String {
    let plan = &tradeoff.plan;
    let spacings: Vec<_> = plan.spacings_s.iter().map(f64::to_string).collect();
    let motions: Vec<_> = plan.motions.iter().map(|motion| motion.name()).collect();
    let section = format!(
        "## Splines\n\n`imu tradeoff spline --spacings {} --motion {} -o FOLDER` wrote this section.\n\n{}\n\n![error \
         over spacing]({orders})\n\n![error over price]({price})\n\n{}{COLUMNS}",
        spacings.join(","),
        motions.join(","),
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
            "position_m": errors.position,
            "rotation_rad": errors.rotation,
            "angular_rate_rad_s": errors.angular_rate,
            "acceleration_m_s2": errors.acceleration,
        })
    };
    let runs = tradeoff.runs.iter().map(|run| {
        json!({
            "motion": run.motion.name(),
            "form": run.form.name(),
            "control_points": run.control.name(),
            "numbers": run.numbers.name(),
            "spacing_s": run.spacing_s,
            "largest": run.errors.as_ref().map(errors),
            "ns_per_full_state": tradeoff.price(run),
        })
    });
    let orders = tradeoff.plan.motions.iter().flat_map(|&motion| {
        curves().map(move |(form, control)| {
            let order = |of| tradeoff.order(motion, form, control, of);
            let [rotation, angular_rate, position, acceleration] =
                ERRORS.map(|(_, of, ..)| order(of));
            json!({
                "motion": motion.name(),
                "form": form.name(),
                "control_points": control.name(),
                "rotation": rotation,
                "angular_rate": angular_rate,
                "position": position,
                "acceleration": acceleration,
            })
        })
    });
    let prices = tradeoff.prices.iter().map(|Price { form, numbers, ns }| {
        json!({ "form": form.name(), "numbers": numbers.name(), "ns_per_full_state": ns })
    });
    json!({
        "spacings_s": tradeoff.plan.spacings_s,
        "motions": tradeoff.plan.motions.iter().map(|motion| motion.name()).collect::<Vec<_>>(),
        "runs": runs.collect::<Vec<_>>(),
        "orders": orders.collect::<Vec<_>>(),
        "prices": prices.collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::spline::{Plan, measure};

    #[test]
    fn every_curve_is_in_every_form() {
        let plan = Plan { spacings_s: vec![0.4, 0.2], motions: vec![Motion::Ellipse] };
        let tradeoff = measure(&plan, |_| {}).unwrap();
        let text = table(&tradeoff);
        assert!(text.contains("ellipse, angular rate: largest error, rad/s"), "{text}");
        assert_eq!(text.matches("poses as control points").count(), 3 * 4);
        let json = json(&tradeoff);
        assert_eq!(json["runs"].as_array().unwrap().len(), 2 * 8 * 4);
        assert_eq!(json["orders"].as_array().unwrap().len(), 8);
        let first = page(None, &tradeoff, ["a.svg", "b.svg"]);
        assert_eq!(page(Some(&first), &tradeoff, ["a.svg", "b.svg"]), first);
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
