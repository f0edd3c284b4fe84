//! What a slow beat of sensor and adapter leaves open: all curves that explain the arrivals, and their mean.
//!
//! Where the adapter's timer and the sensor's period nearly have a common measure, the least wait of a
//! second is no noise: it runs slowly through a tooth, from nothing to its height, and leaps back. Then
//! every curve that has all points within that height above it is as likely as any other: a convex set
//! of levels, slopes and bends. Its mean has the least error that an estimate can have, its scatter is
//! what nobody knows (`docs/live-clock.md`). The height is that of the narrowest strip around all points,
//! once there was a leap; before, a period, or the part of it that bursts of several lengths in turn
//! leave. Some 50 convex hulls of n points each.

use super::envelope::{Curve, MOST_BENT, Point, STRAIGHT_S, bottom_hull};

/// Standard deviation of a clock's bend, ns/s²: 7 ppm in half an hour.
const BEND_SD: f64 = 4.0;

/// A strip so many times wider than the noise of its points holds a leap: of 600 exponential waits one
/// in 15 000 cases.
const LEAP: f64 = 16.0;

/// Parts of a tooth that a leap is as high as, at least; where bursts are [`LONE`], of a period.
const LEAST: f64 = 0.5;
const LEAST_OF_LONE: f64 = 0.02;

/// After so many leaps the lower edge alone is as good, and leans on nothing else.
const MANY: usize = 6;

/// How much wider than the narrowest a strip may be: in noises of a point, and in parts of it.
const SLACK: (f64, f64) = (4.0, 0.02);

/// The longest cycle of burst lengths that is looked for.
const LONGEST_CYCLE: u8 = 16;

/// Bursts of one message each: the frame may be shorter than the period, and a tooth as high as either.
const LONE: u8 = LONGEST_CYCLE + 1;

/// The part of the bursts that are: the rest was read late, with the next.
const MOSTLY_LONE: f64 = 0.9;

/// Seconds that show a cycle are no chance if they are more than this part: without a lock each second
/// has a leap, with one a few have a stall or a lost message.
const LOCKED: f64 = 0.3;

/// Fewer points show nothing.
const FEWEST: usize = 10;

/// Bends and slopes that the mean is taken over, and halvings of an interval.
const GRID: usize = 12;
const HALVINGS: usize = 20;

/// The mean of all curves that explain the points, where a slow beat leaves some open; `None` where the
/// lower edge of the points tells all.
pub(super) fn mean(points: &[Point], period_ns: f64, edge: Curve) -> Option<Curve> {
    let (first, last) = (points.first()?, points.last()?);
    let span = last.t - first.t;
    if points.len() < FEWEST || span <= 0.0 {
        return None;
    }
    let shape = |bend| Shape::of(points, last.t, bend);
    let most = if span < STRAIGHT_S { 0.0 } else { MOST_BENT };
    let best = least(-most, most, |bend| shape(bend).width);
    let width = shape(best).width;
    let noise = noise(points);
    let cycle = cycle(points);
    let lone = cycle == Some(LONE);
    let tooth = cycle.map(|bursts| if lone { period_ns } else { period_ns / f64::from(bursts) });
    let least = if lone { LEAST_OF_LONE } else { LEAST };
    let is_leap = width > LEAP * noise && tooth.is_none_or(|tooth| width > least * tooth);
    let height = if is_leap {
        let leaps = points.windows(2).filter(|w| leap(w) > 0.5 * width).count();
        (leaps <= MANY).then_some(width + SLACK.0 * noise + SLACK.1 * width)?
    } else {
        tooth.filter(|tooth| width < LEAST * tooth)?
    };
    let from = end(best, -most, |bend| shape(bend).width < height);
    let to = end(best, most, |bend| shape(bend).width < height);
    let (mut level, mut slope) = (Weighted::default(), Weighted::default());
    for shape in between(from, to).map(shape).filter(|shape| shape.width < height) {
        let prior = (-0.5 * (shape.bend / BEND_SD).powi(2)).exp();
        let far = 2.0 * height / span;
        let fits = |s: f64| shape.reach(s) < height;
        let from = end(shape.slope, shape.slope - far, fits);
        let to = end(shape.slope, shape.slope + far, fits);
        for s in between(from, to) {
            let (top, bottom) = shape.ends(s);
            let room = (height - (top - bottom)).max(0.0);
            let weight = prior * (to - from) * room;
            slope.take(s, 0.0, weight);
            level.take(bottom - 0.5 * room, room * room / 12.0, weight);
        }
    }
    if level.weight <= 0.0 {
        return None;
    }
    let (level_sd, slope_sd) = (level.sd(), slope.sd());
    // What may be a tenth of a period is no reason to stand half of it below the points.
    let height_is_known = is_leap || !lone;
    let (level, slope) =
        if height_is_known { (level.mean, slope.mean) } else { (edge.level, edge.slope) };
    Some(Curve { level, level_sd, slope, slope_sd, ..edge })
}

/// After how many bursts their lengths repeat, or [`LONE`]; 0: they do not.
pub(super) fn cycle_of(lengths: &[u64]) -> u8 {
    let repeats = |cycle: &u8| {
        let n = usize::from(*cycle);
        lengths.len() >= 3 * n && lengths.iter().zip(lengths.iter().skip(n)).all(|(a, b)| a == b)
    };
    let lone = lengths.iter().filter(|length| **length == 1).count();
    if lengths.len() > 2 && lone as f64 > MOSTLY_LONE * lengths.len() as f64 {
        return LONE;
    }
    (1..=LONGEST_CYCLE).find(repeats).unwrap_or(0)
}

/// The cycle that most seconds show, if some do.
fn cycle(points: &[Point]) -> Option<u8> {
    let seconds = |cycle: u8| points.iter().filter(|p| p.cycle == cycle).count();
    let most = (1..=LONE).rev().max_by_key(|cycle| seconds(*cycle))?;
    (seconds(most) as f64 > LOCKED * points.len() as f64).then_some(most)
}

fn leap(pair: &[Point]) -> f64 {
    if let [a, b] = pair { (b.y - a.y).abs() } else { 0.0 }
}

/// Scale of the exponential noise of points, ns, by their steps: leaps are few.
fn noise(points: &[Point]) -> f64 {
    let median = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let slopes = points.iter().zip(points.iter().skip(1)).map(|(a, b)| (b.y - a.y, b.t - a.t));
    let usual = median(slopes.clone().map(|(y, t)| y / t).collect());
    median(slopes.map(|(y, t)| (y - usual * t).abs()).collect()) / std::f64::consts::LN_2
}

/// Points less a bend, by the corners of their hull.
struct Shape {
    bend: f64,
    bottom: Vec<Point>,
    /// Upside down.
    top: Vec<Point>,
    /// The narrowest strip: its slope, and how high it is.
    slope: f64,
    width: f64,
}

impl Shape {
    fn of(points: &[Point], end: f64, bend: f64) -> Self {
        let (mut bottom, mut top) = (Vec::new(), Vec::new());
        bottom_hull(points, end, bend, 1.0, &mut bottom);
        bottom_hull(points, end, bend, -1.0, &mut top);
        let mut shape = Self { bend, bottom, top, slope: 0.0, width: 0.0 };
        // A strip is narrowest along an edge of the hull.
        let edges = |hull: &[Point], side: f64| {
            let slope = |e: &[Point]| match e {
                [a, b] => side * (b.y - a.y) / (b.t - a.t),
                _ => 0.0,
            };
            hull.windows(2).map(slope).collect::<Vec<_>>()
        };
        let slopes = [edges(&shape.bottom, 1.0), edges(&shape.top, -1.0)].concat();
        let widths = slopes.iter().map(|s| (shape.reach(*s), *s));
        let narrowest = widths.min_by(|a, b| a.0.total_cmp(&b.0));
        (shape.width, shape.slope) = narrowest.unwrap_or((f64::INFINITY, 0.0));
        shape
    }

    /// The highest and the lowest line of this slope through a point: their heights at the end.
    fn ends(&self, slope: f64) -> (f64, f64) {
        let least = |hull: &[Point], s: f64| {
            hull.iter().map(|p| p.y - s * p.t).fold(f64::INFINITY, f64::min)
        };
        (-least(&self.top, -slope), least(&self.bottom, slope))
    }

    /// How high a strip of this slope around all points is.
    fn reach(&self, slope: f64) -> f64 {
        let (top, bottom) = self.ends(slope);
        top - bottom
    }
}

/// Where a function of one hollow is least, by thirds.
fn least(mut from: f64, mut to: f64, height: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..HALVINGS {
        let third = (to - from) / 3.0;
        if third <= 0.0 {
            break;
        }
        if height(from + third) > height(to - third) {
            from += third;
        } else {
            to -= third;
        }
    }
    0.5 * (from + to)
}

/// How far from `from`, where something holds, to `to` it holds.
fn end(mut from: f64, mut to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(to) {
        return to;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if holds(middle) {
            from = middle;
        } else {
            to = middle;
        }
    }
    from
}

/// The middles of [`GRID`] equal parts.
fn between(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..GRID).map(move |k| from + (to - from) * (k as f64 + 0.5) / GRID as f64)
}

/// Mean and variance under weights (West 1979).
#[derive(Clone, Copy, Default)]
struct Weighted {
    weight: f64,
    mean: f64,
    squares: f64,
}

impl Weighted {
    /// Takes a value with a variance of its own.
    fn take(&mut self, value: f64, variance: f64, weight: f64) {
        if weight <= 0.0 {
            return;
        }
        self.weight += weight;
        let distance = value - self.mean;
        self.mean += distance * weight / self.weight;
        self.squares += weight * (distance * (value - self.mean) + variance);
    }

    fn sd(&self) -> f64 {
        (self.squares / self.weight).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::envelope;
    use super::*;

    const TOOTH: f64 = 1e6;

    /// Bursts of equal length, which stand still until sensor and timer have passed each other by a
    /// period of 1 ms; `rate` ns/s, from half a period on. With up to 6 µs of noise.
    fn beat(rate: f64, cycle: u8) -> Vec<Point> {
        let at = |i: i32| {
            let t = f64::from(i);
            let wait = (0.5 * TOOTH - rate * t).rem_euclid(TOOTH);
            Point { t, y: rate * t + wait + f64::from((i * 37) % 7) * 1e3, cycle }
        };
        (0..600).map(at).collect()
    }

    fn mean_of(points: &[Point]) -> Option<Curve> {
        mean(points, TOOTH, envelope::under(points, &mut Vec::new()).unwrap())
    }

    #[test]
    fn without_a_leap_what_is_not_known_is_said() {
        for rate in [-800.0, 0.0, 700.0] {
            let curve = mean_of(&beat(rate, 1)).unwrap();
            // Of straight lines, slopes up to a period in 600 s either way: a triangular law, whose
            // standard deviation is 1/√6 of that. Bends add to it, less than the steepest line.
            let most = TOOTH / 600.0;
            assert!((0.4..1.0).contains(&(curve.slope_sd / most)), "{curve:?}");
            assert!((curve.slope - rate).abs() < 3.0 * curve.slope_sd, "{curve:?}");
            // The wait is anything up to a period: a uniform law.
            assert!((curve.level_sd / TOOTH - 1.0 / 12_f64.sqrt()).abs() < 0.02, "{curve:?}");
            // Of bursts in cycles of five the phase is known to a fifth.
            let curve = mean_of(&beat(rate / 5.0, 5)).unwrap();
            assert!((0.08..0.4).contains(&(curve.slope_sd / most)), "{curve:?}");
        }
    }

    #[test]
    fn leaps_show_rate_and_phase() {
        // Three leaps, the last of them 100 s ago.
        for rate in [-5000.0, 5000.0] {
            let curve = mean_of(&beat(rate, 1)).unwrap();
            let error = curve.level - 599.0 * rate;
            assert!(
                error.abs() < 3.0 * curve.level_sd && curve.level_sd < 0.1 * TOOTH,
                "{curve:?}"
            );
            assert!((curve.slope - rate).abs() < 3.0 * curve.slope_sd, "{curve:?}");
            assert!(curve.slope_sd < 500.0, "{curve:?}");
        }
    }

    #[test]
    fn where_nothing_is_hidden_the_edge_is_left_alone() {
        // A leap every second, and bursts of lengths that never repeat.
        assert_eq!(mean_of(&beat(0.37 * TOOTH, 0)), None);
        // Many leaps.
        assert_eq!(mean_of(&beat(0.02 * TOOTH, 1)), None);
        assert_eq!(mean_of(&beat(0.0, 1)[..5]), None);
    }

    #[test]
    fn bursts_repeat_or_not() {
        let of = |lengths: &[u64]| cycle_of(lengths);
        assert_eq!(of(&[16; 62]), 1);
        assert_eq!(of(&[1, 2, 2, 1, 2].repeat(12)), 5);
        assert_eq!(of(&[[16; 30], [17; 30]].concat()), 0);
        assert_eq!(of(&[1; 90]), LONE);
        assert_eq!(of(&[]), 0);
    }
}
