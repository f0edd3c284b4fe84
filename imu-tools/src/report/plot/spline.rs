//! Splines: error over knot spacing, where a slope is an order, and error over price.

use super::chart::Chart;
use super::scale::Scale;
use super::{Figure, WIDTH};
use crate::tradeoff::rules::motion::Motion;
use crate::tradeoff::spline::{Control, Errors, Form, NUMBERS, Numbers, Tradeoff};

const HEIGHT: f64 = 420.0;

/// One error of a curve.
type Of = fn(&Errors) -> f64;

/// What of a curve is drawn: its errors with their names.
const ERRORS: [(&str, &str, Of); 4] = [
    ("rotation", "largest error, rad", |errors| errors.rotation),
    ("angular rate", "largest error, rad/s", |errors| errors.angular_rate),
    ("position", "largest error, m", |errors| errors.position),
    ("acceleration", "largest error, m/s²", |errors| errors.acceleration),
];

/// Curves of the first plot: their class, name, and the dot at which their order stands.
const LINES: [(Form, Control, &str, &str, usize); 5] = [
    (Form::Plain, Control::Interpolation, "line rule0", "plain", 2),
    (Form::Symmetric, Control::Interpolation, "line rule3", "symmetric", 1),
    (Form::Symmetric, Control::QuasiInterpolant, "line rule5", "symmetric, quasi-interpolant", 3),
    (Form::Coupled, Control::QuasiInterpolant, "line rule4", "SE(3)", 2),
    (Form::Plain, Control::PosesThemselves, "line rule1 dashed", "poses as control points", 1),
];

/// Columns of the second.
const COLUMNS: [(Form, Control, &str); 3] = [
    (Form::Plain, Control::Interpolation, "line rule0"),
    (Form::Symmetric, Control::Interpolation, "line rule3"),
    (Form::Coupled, Control::QuasiInterpolant, "line rule4"),
];

/// Error over spacing in `f64` on the first motion, a line for each curve; its order by name.
#[must_use]
pub fn spline_orders(tradeoff: &Tradeoff) -> Figure {
    let description =
        "Largest error over knot spacing, of splines; the slope of a line is its order";
    let motion = tradeoff.plan.motions.first().copied().unwrap_or(Motion::Ellipse);
    let charts = ERRORS.into_iter().enumerate().map(|(k, (what, y_name, of))| {
        let lines = LINES.map(|(form, control, ..)| {
            let runs = tradeoff.of(motion, form, control, Numbers::F64);
            let points = runs.filter_map(|run| Some((run.spacing_s, of(&run.errors?))));
            points.collect::<Vec<_>>()
        });
        let points = || lines.iter().flatten().copied();
        let mut chart = Chart::new(
            (0.0, k as f64 * HEIGHT),
            (WIDTH, HEIGHT),
            Scale::decades(points().map(|(spacing, _)| spacing)),
            Scale::decades(points().map(|(_, error)| error)),
        );
        for ((form, control, class, name, dot), points) in LINES.into_iter().zip(&lines) {
            chart.line(class, points);
            chart.dots("mark", points);
            chart.name(class, name);
            let order = tradeoff.order(motion, form, control, of);
            if let (Some(at), Some(order)) = (points.get(dot), order) {
                let below = form == Form::Symmetric;
                chart.mark("mark", *at, below, &format!("order {order:.2}"));
            }
        }
        let x_name = format!("from knot to knot, s ({})", motion.name());
        chart.finish(&format!("spline-orders-{k}"), what, &x_name, y_name)
    });
    Figure::new(description.into(), charts, HEIGHT)
}

/// Errors of rotation, ω and a over the price of a full state on the first motion: a dot for each spacing, the widest
/// highest, in all numbers.
#[must_use]
pub fn spline_price(tradeoff: &Tradeoff) -> Figure {
    let description = "Largest error over the price of a full state, of splines at all spacings";
    let motion = tradeoff.plan.motions.first().copied().unwrap_or(Motion::Ellipse);
    let shown = ERRORS.into_iter().filter(|(what, ..)| *what != "position");
    let charts = shown.enumerate().map(|(k, (what, y_name, of))| {
        let all = COLUMNS.into_iter().flat_map(|c| NUMBERS.map(|numbers| (c, numbers)));
        let columns: Vec<_> = all
            .map(|((form, control, class), numbers)| {
                let runs = tradeoff.of(motion, form, control, numbers);
                let points = runs.filter_map(|run| Some((tradeoff.price(run)?, of(&run.errors?))));
                (class, numbers, points.collect::<Vec<_>>())
            })
            .collect();
        let points = || columns.iter().flat_map(|(.., points)| points).copied();
        let mut chart = Chart::new(
            (0.0, k as f64 * HEIGHT),
            (WIDTH, HEIGHT),
            Scale::decades(points().flat_map(|(price, _)| [price, 1.2 * price])),
            Scale::decades(points().map(|(_, error)| error)),
        );
        for (place, (class, numbers, points)) in columns.iter().enumerate() {
            chart.line(class, points);
            chart.dots("mark", points);
            // Names of neighbouring columns stand at different heights.
            let at = points.get(place % NUMBERS.len()).or(points.last());
            if let Some(at) = at {
                chart.mark("mark", *at, false, numbers.name());
            }
        }
        for (form, _, class) in COLUMNS {
            chart.name(class, form.name());
        }
        let title = format!("{}: {what}", motion.name());
        chart.finish(&format!("spline-price-{k}"), &title, "price, ns a full state", y_name)
    });
    Figure::new(description.into(), charts, HEIGHT)
}
