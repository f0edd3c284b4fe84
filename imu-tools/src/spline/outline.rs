//! A fit's outline for a picture: points enough, and no more.

use super::{Route, TimedPose};

/// Points of a line, at most.
const MOST: i64 = 4000;

/// What there is to draw; times in s after the first pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Poses: time and position, m.
    pub poses: Vec<(f64, [f64; 3])>,
    /// The curve: time, position in m, acceleration in the world's axes in m/s².
    pub curve: Vec<(f64, [f64; 3], [f64; 3])>,
    /// From poses to the curve: time, m, rad; of each stretch of poses the largest.
    pub residuals: Vec<(f64, f64, f64)>,
}

impl Outline {
    /// Of a curve and the poses that it was fitted to.
    #[must_use]
    pub fn of(route: &Route, poses: &[TimedPose]) -> Self {
        let Some(begin) = poses.first().map(|pose| pose.stamp_ns) else { return Self::default() };
        let at = |stamp_ns: i64| (i128::from(stamp_ns) - i128::from(begin)) as f64 / 1e9;
        let stretch = poses.len().div_ceil(MOST as usize);
        let shown = poses.iter().step_by(stretch);
        let shown = shown.map(|p| (at(p.stamp_ns), p.pose.translation().into()));
        let residuals = poses.chunks(stretch).map(|stretch| {
            let distances = stretch.iter().filter_map(|pose| {
                let there = route.full(pose.stamp_ns).ok()?.pose;
                Some(super::distance::between(&there, &pose.pose))
            });
            let largest = distances.fold((0.0, 0.0), |(a, b), (m, rad)| (m.max(a), rad.max(b)));
            (stretch.first().map_or(0.0, |pose| at(pose.stamp_ns)), largest.0, largest.1)
        });
        let (first, last) = route.span_ns();
        let length = i128::from(last) - i128::from(first);
        let curve = (0..=MOST).filter_map(|k| {
            let t_ns = i128::from(first) + length * i128::from(k) / i128::from(MOST);
            let t_ns = i64::try_from(t_ns).ok()?;
            let full = route.full(t_ns).ok()?;
            Some((at(t_ns), full.pose.translation().into(), full.acceleration_w.into()))
        });
        Self { poses: shown.collect(), residuals: residuals.collect(), curve: curve.collect() }
    }
}
