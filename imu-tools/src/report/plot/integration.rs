//! Dead reckoning in pictures: where each rule went, and how its error grew.

use super::chart::{Chart, Drawn, Key, legend};
use super::scale::{Scale, time};
use super::{Figure, WIDTH};
use crate::integrate::{ErrorAt, Integration, Method, Outcome, PathPoint};

/// Errors this much smaller than the largest are below the frame.
const DEPTH: f64 = 1e-10;

const TRUTH: &str = "line truth";

/// The colour of a rule; the textbook forms, which hardly differ from the others, are dashed.
const fn class(method: Method) -> &'static str {
    match method {
        Method::Euler | Method::PreviousIncrement => "line rule0",
        Method::TextbookEuler => "line rule1 dashed",
        Method::Midpoint => "line rule3",
        Method::TextbookMidpoint => "line rule2 dashed",
        Method::ConingSculling => "line rule4",
        Method::ThreeSample | Method::TwoIncrements => "line rule5",
    }
}

fn keys(integration: &Integration, truth: bool) -> (Drawn, f64) {
    let truth = truth.then(|| Key { class: TRUTH, name: "truth".into() });
    let rules = integration.outcomes.iter().map(|outcome| outcome.method);
    let rules = rules.map(|method| Key { class: class(method), name: method.name().into() });
    legend(truth.into_iter().chain(rules).collect(), WIDTH)
}

/// Dashed lines over solid ones, so that both are seen where they lie on each other.
fn dashed_last(integration: &Integration) -> impl Iterator<Item = &Outcome> {
    let is_dashed = |outcome: &&Outcome| class(outcome.method).contains("dashed");
    let solid = integration.outcomes.iter().filter(move |outcome| !is_dashed(outcome));
    solid.chain(integration.outcomes.iter().filter(is_dashed))
}

/// From above, a metre as long in both directions, and height over time.
#[must_use]
pub fn trajectory(integration: &Integration) -> Figure {
    const SIZES: [f64; 2] = [640.0, 300.0];
    let has_truth = integration.true_path.points().next().is_some();
    let (keys, top) = keys(integration, has_truth);
    let all = || {
        let found = integration.outcomes.iter().flat_map(|outcome| outcome.path.points());
        found.chain(integration.true_path.points())
    };
    let axis = |axis: usize| Scale::around(all().map(move |point| point.position_w[axis]));
    let mut above = Chart::equal((0.0, top), (WIDTH, SIZES[0]), axis(0), axis(1));
    let end = all().map(|point| point.t_s).fold(0.0, f64::max);
    let (unit, per_second) = time(end);
    let at = (0.0, top + SIZES[0]);
    let mut height =
        Chart::new(at, (WIDTH, SIZES[1]), Scale::between(0.0, end * per_second), axis(2));
    let mut draw = |class: &str, points: &mut dyn Iterator<Item = PathPoint>| {
        let points: Vec<PathPoint> = points.collect();
        let [from_above, of_height] = [
            points.iter().map(|p| (p.position_w[0], p.position_w[1])).collect::<Vec<_>>(),
            points.iter().map(|p| (p.t_s * per_second, p.position_w[2])).collect(),
        ];
        above.line(class, &from_above);
        height.line(class, &of_height);
    };
    for Outcome { method, path, .. } in dashed_last(integration) {
        draw(class(*method), &mut path.points());
    }
    if has_truth {
        draw(TRUTH, &mut integration.true_path.points());
    }
    let charts = [
        (keys, top),
        (above.finish("above", "from above", "x, m", "y, m"), SIZES[0]),
        (height.finish("height", "height", &format!("time, {unit}"), "z, m"), SIZES[1]),
    ];
    Figure::stacked("Where dead reckoning went".into(), charts.into_iter())
}

/// Errors of position and attitude over time, logarithmic; empty without a truth.
#[must_use]
pub fn errors(integration: &Integration) -> Figure {
    const HEIGHT: f64 = 340.0;
    let description = "Errors of dead reckoning over time".to_owned();
    let curves = || integration.outcomes.iter().flat_map(|outcome| outcome.error_curve.points());
    let end = curves().map(|at| at.t_s).fold(0.0, f64::max);
    if end <= 0.0 {
        return Figure::stacked(description, std::iter::empty());
    }
    let (unit, per_second) = time(end);
    let (keys, top) = keys(integration, false);
    let quantities = [
        ("error-position", "distance to the true position", "m"),
        ("error-attitude", "angle to the true attitude", "°"),
    ];
    let charts = quantities.iter().enumerate().map(|(k, (id, title, y_unit))| {
        let of = |at: &ErrorAt| if k == 0 { at.position_m } else { at.rotation_rad.to_degrees() };
        let most = curves().map(|at| of(&at)).fold(0.0, f64::max);
        let shown = curves().map(|at| of(&at)).filter(|error| *error >= DEPTH * most);
        let place = (0.0, top + k as f64 * HEIGHT);
        let x = Scale::between(0.0, end * per_second);
        let mut chart = Chart::new(place, (WIDTH, HEIGHT), x, Scale::decades(shown));
        for Outcome { method, error_curve, .. } in dashed_last(integration) {
            let points: Vec<_> =
                error_curve.points().map(|at| (at.t_s * per_second, of(&at))).collect();
            chart.line(class(*method), &points);
        }
        (chart.finish(id, title, &format!("time, {unit}"), y_unit), HEIGHT)
    });
    Figure::stacked(description, std::iter::once((keys, top)).chain(charts))
}
