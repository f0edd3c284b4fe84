//! The highest curve that no arrival lies under: straight at first, bent a little over minutes.
//!
//! A message is never read before it was sent, but often long after. So of arrival minus sensor time
//! only the lower edge tells of the two clocks. The line under all points that lies highest in their
//! mean is an edge of their convex hull (Zhang, Liu & Xia 2002, "Clock synchronization algorithms for
//! network measurements"); where delays are exponential it is the likeliest one (Moon, Skelly & Towsley
//! 1999, "Estimation and removal of clock skew from network delay measurements"). A clock that warms up
//! bends: the bend that lets the curve lie highest is found by golden section, each step a hull. One
//! fit of n points costs 25 n steps; `docs/live-clock.md` says what it achieves.

/// The earliest arrival of a second or so.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Point {
    /// Sensor time, s.
    pub t: f64,
    /// Arrival minus sensor time, ns.
    pub y: f64,
    /// After so many bursts their lengths repeat, in this second; 0: they do not.
    pub cycle: u8,
}

/// The curve at its end, where the last point is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Curve {
    /// Where the last point is, s.
    pub t: f64,
    /// Its height there, ns.
    pub level: f64,
    /// Its slope there, ns/s.
    pub slope: f64,
    /// Standard deviations of both, ns and ns/s.
    pub level_sd: f64,
    pub slope_sd: f64,
    /// From the first point to the last, s.
    pub span: f64,
    /// How many points there are.
    pub points: f64,
}

/// Shorter stretches are taken for straight, s: a bend of [`MOST_BENT`] makes 10 µs of a minute.
pub(super) const STRAIGHT_S: f64 = 100.0;

/// The most that a clock's rate changes, ns/s²: 20 ppm in half an hour.
pub(super) const MOST_BENT: f64 = 11.0;

/// How fast a bend changes, ns/s³: one of 4 ns/s² turns in ten minutes.
const JERK: f64 = 6e-3;

/// Steps of golden section: to 0.618²⁰, 1e-4 of the range.
const STEPS: usize = 20;

/// The curve under points in the order of their times; `None` where there are fewer than two.
pub(super) fn under(points: &[Point], hull: &mut Vec<Point>) -> Option<Curve> {
    let (first, last) = (points.first()?, points.last()?);
    let span = last.t - first.t;
    if span <= 0.0 {
        return None;
    }
    let mean = points.iter().map(|p| p.t - last.t).sum::<f64>() / points.len() as f64;
    // Height in the mean of the points, for a bend: to be as great as can be. Without the mean of
    // the bend itself it is minus the mean distance.
    let mean_square =
        points.iter().map(|p| (p.t - last.t).powi(2)).sum::<f64>() / points.len() as f64;
    let mut height = |bend: f64| {
        let (level, slope) = line(points, last.t, mean, bend, hull);
        level + slope * mean + 0.5 * bend * mean_square
    };
    let bend = if span < STRAIGHT_S { 0.0 } else { highest(&mut height) };
    let (level, slope) = line(points, last.t, mean, bend, hull);
    let distance = |p: &Point| {
        let t = p.t - last.t;
        p.y - (level + (slope + 0.5 * bend * t) * t)
    };
    let n = points.len() as f64;
    let above = points.iter().map(distance).sum::<f64>() / n;
    // The free end of a parabola through n points at σ, over a span: 3σ/√n, and its slope σ√192/(span·√n).
    // The points under which a curve was laid are at their mean distance from it, or so. What is no
    // parabola is a Chebyshev polynomial of the third degree, jerk·span³/192 high, and 18/span as steep.
    let sd = if n > 2.0 { above / n.sqrt() } else { f64::INFINITY };
    let cubic = JERK * span.powi(3) / 192.0;
    let level_sd = cubic.hypot(3.0 * sd);
    let slope_sd = (18.0 * cubic).hypot(192_f64.sqrt() * sd) / span;
    Some(Curve { t: last.t, level, slope, level_sd, slope_sd, span, points: n })
}

/// Where a function of one hump is highest between ∓[`MOST_BENT`] (Kiefer 1953).
fn highest(height: &mut impl FnMut(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (-MOST_BENT, MOST_BENT);
    let mut at = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut heights = at.map(&mut *height);
    for _ in 0..STEPS {
        if heights[0] > heights[1] {
            high = at[1];
            at = [high - GOLDEN * (high - low), at[0]];
            heights = [height(at[0]), heights[0]];
        } else {
            low = at[0];
            at = [at[1], low + GOLDEN * (high - low)];
            heights = [heights[1], height(at[1])];
        }
    }
    0.5 * (low + high)
}

/// The edge of the lower hull over `mean`, of points less ½·bend·t²: height at `end`, and slope.
fn line(points: &[Point], end: f64, mean: f64, bend: f64, hull: &mut Vec<Point>) -> (f64, f64) {
    bottom_hull(points, end, bend, 1.0, hull);
    let over = hull.windows(2).find(|e| matches!(e, [_, b] if b.t >= mean));
    match over {
        Some([a, b]) => {
            let slope = (b.y - a.y) / (b.t - a.t);
            (b.y - slope * b.t, slope)
        }
        _ => (hull.last().map_or(0.0, |p| p.y), 0.0),
    }
}

/// The lower hull of points less ½·bend·t², in times before `end`; `side` −1 turns them upside down.
pub(super) fn bottom_hull(points: &[Point], end: f64, bend: f64, side: f64, hull: &mut Vec<Point>) {
    hull.clear();
    for p in points {
        let t = p.t - end;
        let next = Point { t, y: side * (p.y - 0.5 * bend * t * t), ..*p };
        // Andrew's chain: whatever is not under the line to the next point is no corner.
        while let [.., a, b] = hull.as_slice() {
            if (b.y - a.y) * (next.t - a.t) < (next.y - a.y) * (b.t - a.t) {
                break;
            }
            hull.pop();
        }
        if let [a] = hull.as_slice()
            && a.t >= next.t
        {
            if next.y >= a.y {
                continue;
            }
            hull.pop();
        }
        hull.push(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_is_under_the_curve_and_three_touch_it() {
        // A parabola of bend 5 ns/s² under points that are on it every 7 s and higher elsewhere.
        let truth = |t: f64| 1e5 + 300.0 * t + 2.5 * t * t;
        let points: Vec<Point> = (0..400)
            .map(|i| {
                let t = f64::from(i);
                Point { t, y: truth(t) + f64::from((i * 37) % 7) * 1e4, cycle: 0 }
            })
            .collect();
        let curve = under(&points, &mut Vec::new()).unwrap();
        // A bend that is off by e moves the end by ⅛·e·span²: golden section ends at 22·0.618²⁰ = 1.5e-3.
        assert!((curve.level - truth(399.0)).abs() < 60.0, "{curve:?}");
        assert!((curve.slope - (300.0 + 5.0 * 399.0)).abs() < 1.0, "{curve:?}");
    }

    #[test]
    fn two_points_make_a_line_and_one_none() {
        let points = [Point { t: 1.0, y: 5.0, cycle: 0 }, Point { t: 2.0, y: 3.0, cycle: 0 }];
        let curve = under(&points, &mut Vec::new()).unwrap();
        assert_eq!((curve.level, curve.slope), (3.0, -2.0));
        assert_eq!(under(&points[..1], &mut Vec::new()), None);
        assert_eq!(under(&[points[0]; 2], &mut Vec::new()), None);
    }
}
