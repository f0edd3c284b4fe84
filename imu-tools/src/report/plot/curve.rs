//! A curve through poses in pictures: where it runs, how far from the poses, and how it accelerates.

use super::chart::{Chart, Drawn, Key, legend};
use super::scale::{Scale, time};
use super::{AXES, Figure, WIDTH};
use crate::spline::Outline;

const CURVE: &str = "line rule3";
const POSES: &str = "dot pose";
const HEIGHT: f64 = 280.0;

/// Poses and curve from above, a metre as long in both directions, and their height over time.
#[must_use]
pub fn curve(outline: &Outline) -> Figure {
    const ABOVE: f64 = 640.0;
    let keys = [(CURVE, "curve"), (POSES, "poses")];
    let (keys, top) =
        legend(keys.map(|(class, name)| Key { class, name: name.into() }).into(), WIDTH);
    let axis = |axis: usize| {
        let curve = outline.curve.iter().map(move |(_, p, _)| p[axis]);
        Scale::around(curve.chain(outline.poses.iter().map(move |(_, p)| p[axis])))
    };
    let (unit, per_second) = time(end(outline));
    let mut above = Chart::equal((0.0, top), (WIDTH, ABOVE), axis(0), axis(1));
    let mut height = Chart::new((0.0, top + ABOVE), (WIDTH, HEIGHT), times(outline), axis(2));
    let line: Vec<_> = outline.curve.iter().map(|(_, p, _)| (p[0], p[1])).collect();
    let dots: Vec<_> = outline.poses.iter().map(|(_, p)| (p[0], p[1])).collect();
    above.dots(POSES, &dots);
    above.line(CURVE, &line);
    let line: Vec<_> = outline.curve.iter().map(|(t, p, _)| (t * per_second, p[2])).collect();
    let dots: Vec<_> = outline.poses.iter().map(|(t, p)| (t * per_second, p[2])).collect();
    height.dots(POSES, &dots);
    height.line(CURVE, &line);
    let charts = [
        (keys, top),
        (above.finish("above", "from above", "x, m", "y, m"), ABOVE),
        (height.finish("height", "height", &format!("time, {unit}"), "z, m"), HEIGHT),
    ];
    Figure::stacked("A curve through poses".into(), charts.into_iter())
}

/// The distance of every pose, and the acceleration, over time.
#[must_use]
pub fn curve_residual(outline: &Outline) -> Figure {
    let (unit, per_second) = time(end(outline));
    let x_name = format!("time, {unit}");
    let residual =
        |at: f64, id: &str, title: &str, y_name: &str, of: fn(&(f64, f64, f64)) -> f64| {
            let points: Vec<_> =
                outline.residuals.iter().map(|row| (row.0 * per_second, of(row))).collect();
            let most = points.iter().map(|(_, y)| *y).fold(0.0, f64::max);
            let y = Scale::between(0.0, 1.05 * most);
            let mut chart = Chart::new((0.0, at), (WIDTH, HEIGHT), times(outline), y);
            chart.line(CURVE, &points);
            chart.finish(id, title, &x_name, y_name)
        };
    let charts = [
        residual(0.0, "position", "from the poses to the curve", "m", |row| row.1),
        residual(HEIGHT, "attitude", "from their attitudes to the curve's", "°", |row| {
            row.2.to_degrees()
        }),
        acceleration(outline, 2.0 * HEIGHT, per_second, &x_name),
    ];
    Figure::new(
        "How far a curve is from its poses, and its acceleration".into(),
        charts.into_iter(),
        HEIGHT,
    )
}

fn acceleration(outline: &Outline, at: f64, per_second: f64, x_name: &str) -> Drawn {
    let all = outline.curve.iter().flat_map(|(_, _, a)| *a);
    let mut chart = Chart::new((0.0, at), (WIDTH, HEIGHT), times(outline), Scale::around(all));
    let classes = ["line x", "line y", "line z"];
    for (axis, (class, name)) in classes.iter().zip(AXES).enumerate() {
        let points: Vec<_> =
            outline.curve.iter().map(|(t, _, a)| (t * per_second, a[axis])).collect();
        chart.line(class, &points);
        chart.name(class, name);
    }
    chart.finish("acceleration", "acceleration, world axes", x_name, "m/s²")
}

/// The last instant, s.
fn end(outline: &Outline) -> f64 {
    outline.curve.last().map_or(1.0, |(t, ..)| *t)
}

fn times(outline: &Outline) -> Scale {
    let (_, per_second) = time(end(outline));
    let begin = outline.curve.first().map_or(0.0, |(t, ..)| *t);
    Scale::between(begin * per_second, end(outline) * per_second)
}
