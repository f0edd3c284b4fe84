//! Interpolation: the control points whose curve goes through given poses, one at every knot.
//!
//! Positions: c₍ᵢ₋₁₎ + 4cᵢ + c₍ᵢ₊₁₎ = 6pᵢ, tridiagonal, solved in place. No pose decides the outermost control points:
//! their fifth difference is nothing, a degree above the "not a knot" condition of de Boor (1978, "A practical guide to
//! splines", chapter IV), so that the curve is as good at both ends as in between. As δ²c = 6(p − c) at every knot, this
//! is c₁ − q₁ = c₂ − q₂ with the quasi-interpolant q = p − δ²p/6, and the matrix stays tridiagonal.
//!
//! Attitudes: sweeps. What the curve still lacks at every knot, log(SᵢᵀRᵢ), is solved for as positions are, and the
//! control points turn by the result. Neighbours that turn by θ against each other gain a factor of about θ with every
//! sweep: 3 to 6 where steps turn by a few degrees and their turns change smoothly, 10 to 20 where they change at random.
//! Beyond half a radian at random sweeps may stay away from the poses: [`Interpolated::rotation_error`] tells.

use super::control::{Attitudes, are_neighbours};
use super::so3::Form;
use crate::se3::Pose;
use crate::vector::dot;
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// Where sweeps end that do not settle.
const MOST_SWEEPS: u32 = 64;

/// How well a curve goes through what it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolated<T> {
    /// The largest angle between the curve and an attitude given, rad: some roundings, where the sweeps settled.
    pub rotation_error: T,
    /// How many sweeps that took.
    pub sweeps: u32,
}

/// Fills `control`, of two more than there are poses, with the control points of the curve of form `F` through `poses`.
/// `scratch` holds as many vectors as there are poses; what is in it does not matter.
///
/// Where the first pose is of `t` ns, and the next `step_ns` later, the first control point is of `t − step_ns`:
/// [`from_control_points`](super::SplitCurve::from_control_points) takes `t − step_ns`, `step_ns` and `control`, and the curve spans the
/// poses from the first to the last.
///
/// Error of the curve between the poses of a smooth motion, in the step h: h⁴ in position, and in attitude h³
/// ([`OneSided`](super::OneSided)) or h⁴ ([`TimeSymmetric`](super::TimeSymmetric)).
///
/// Solve in `f64`, and [`cache`](super::cache) into `f32` if the curve is to be in that: control points in `f32` are
/// rounded like the poses, to 10⁻⁶ m at 20 m, of which a second difference over 10 ms makes some 3·10⁻² m/s².
///
/// # Errors
/// [`Error::OutOfRange`], naming `poses` where there are fewer than four, `control` or `scratch` where its length is
/// not as said, `turn between neighbours` where two poses, or the control points that come of them, are further apart
/// than π − 10⁻³ rad.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::se3::Pose;
/// use imu_core::so3;
/// use imu_core::spline::{SymmetricSplitSpline, TimeSymmetric, interpolate};
///
/// let at = |t: f64| Pose::new(so3::exp(Vector3::new(0.3 * t.sin(), 0.2 * t.cos(), t)), Vector3::new(t.cos(), t.sin(), 0.0));
/// let mut poses = [Pose::identity(); 11];
/// for (k, pose) in (0..).zip(&mut poses) {
///     *pose = at(0.1 * f64::from(k))?;
/// }
/// let (mut control, mut scratch) = ([Pose::identity(); 13], [Vector3::zeros(); 11]);
/// interpolate::<f64, TimeSymmetric>(&poses, &mut control, &mut scratch)?;
/// let curve = SymmetricSplitSpline::from_control_points(-100_000_000, 100_000_000, &control)?;
/// let (there, truth) = (curve.pose(450_000_000)?, at(0.45)?);
/// assert!((there.translation() - truth.translation()).abs().max() < 1e-6);
/// # Ok::<(), imu_core::Error>(())
/// ```
pub fn interpolate<T: Real, F: Form<T>>(
    poses: &[Pose<T>],
    control: &mut [Pose<T>],
    scratch: &mut [Vector3<T>],
) -> Result<Interpolated<T>, Error> {
    if poses.len() < 4 {
        return Err(Error::OutOfRange("poses"));
    }
    if control.len().checked_sub(poses.len()) != Some(2) {
        return Err(Error::OutOfRange("control"));
    }
    if scratch.len() != poses.len() {
        return Err(Error::OutOfRange("scratch"));
    }
    check(poses)?;
    begin(poses, control)?;
    scratch.iter_mut().zip(poses).for_each(|(value, pose)| *value = pose.translation());
    let ends = solve(scratch)?;
    let solved = with_ends(&ends, scratch);
    control.iter_mut().zip(solved).for_each(|(point, place)| {
        *point = Pose::of_unit(point.rotation(), place);
    });
    sweep::<T, F>(poses, control, scratch)
}

fn check<T: Real>(poses: &[Pose<T>]) -> Result<(), Error> {
    poses
        .iter()
        .zip(poses.iter().skip(1))
        .try_for_each(|(a, b)| are_neighbours(&a.rotation(), &b.rotation()))
}

/// Begins with the attitudes themselves, and beyond both ends with what the turns there suggest.
fn begin<T: Real>(poses: &[Pose<T>], control: &mut [Pose<T>]) -> Result<(), Error> {
    let attitudes = || poses.iter().map(Pose::rotation);
    let ends = beyond(attitudes(), poses.len()).zip(beyond(attitudes().rev(), poses.len()));
    let (before, after) = ends.ok_or(Error::OutOfRange("poses"))?;
    let all = core::iter::once(before).chain(attitudes()).chain(core::iter::once(after));
    control.iter_mut().zip(all).for_each(|(point, attitude)| {
        *point = Pose::of_unit(attitude, point.translation());
    });
    Ok(())
}

/// What comes before attitudes, from the turns between the first five of them (or four, if there are no more), which
/// are taken for values of a cubic (or a parabola).
fn beyond<T: Real>(
    mut attitudes: impl Iterator<Item = Quaternion<T>>,
    count: usize,
) -> Option<Quaternion<T>> {
    let weights: &[i32] = if count > 4 { &[4, -6, 4, -1] } else { &[3, -3, 1] };
    let first = attitudes.next()?;
    let mut before = first;
    let mut step = Vector3::from([T::ZERO; 3]);
    for (weight, next) in weights.iter().zip(attitudes) {
        let turn = so3::log(&so3::product(&so3::inverse(&before), &next));
        step += turn * T::from_i32(*weight);
        before = next;
    }
    Some(so3::renormalised(&so3::product(&first, &so3::exp(-step))))
}

/// Turns the control points until the curve goes through the attitudes, or comes no nearer.
fn sweep<T: Real, F: Form<T>>(
    poses: &[Pose<T>],
    control: &mut [Pose<T>],
    scratch: &mut [Vector3<T>],
) -> Result<Interpolated<T>, Error> {
    let settled = T::from_u32(4) * T::EPSILON;
    let mut before = T::MAX;
    let mut sweeps = 0;
    loop {
        let error = lacking::<T, F>(poses, control, scratch)?;
        let done = error <= settled || error > before * T::from_f64(0.9) || sweeps == MOST_SWEEPS;
        if done {
            return Ok(Interpolated { rotation_error: error, sweeps });
        }
        before = error;
        sweeps += 1;
        let ends = solve(scratch)?;
        control.iter_mut().zip(with_ends(&ends, scratch)).for_each(|(point, turn)| {
            let turned = so3::product(&point.rotation(), &so3::exp(turn));
            *point = Pose::of_unit(so3::renormalised(&turned), point.translation());
        });
    }
}

/// log(SᵢᵀRᵢ) at every knot, and the largest angle of them.
fn lacking<T: Real, F: Form<T>>(
    poses: &[Pose<T>],
    control: &[Pose<T>],
    lack: &mut [Vector3<T>],
) -> Result<T, Error> {
    let mut largest = T::ZERO;
    let windows = control.iter().zip(control.iter().skip(1)).zip(control.iter().skip(2));
    let mut before: Option<Pose<T>> = None;
    for (((pose, lack), ((a, b), c)), d) in
        poses.iter().zip(lack).zip(windows).zip(control.iter().skip(3).map(Some).chain([None]))
    {
        // The last pose is at the end of the interval before.
        let (four, u) = match (d, before) {
            (Some(d), _) => ([*a, *b, *c, *d], T::ZERO),
            (None, Some(before)) => ([before, *a, *b, *c], T::ONE),
            (None, None) => return Err(Error::OutOfRange("poses")),
        };
        before = Some(*a);
        for (one, next) in four.iter().zip(four.iter().skip(1)) {
            are_neighbours(&one.rotation(), &next.rotation())?;
        }
        let there = F::attitude(&Attitudes::turns(&four), u);
        *lack = so3::log(&so3::product(&so3::inverse(&there), &pose.rotation()));
        let square = dot(lack, lack);
        if square > largest {
            largest = square;
        }
    }
    Ok(largest.sqrt())
}

/// Values at the knots into control points, in place; those beyond both ends come back.
fn solve<T: Real>(values: &mut [Vector3<T>]) -> Result<[Vector3<T>; 2], Error> {
    let missing = Error::OutOfRange("poses");
    let (Some(&first), Some(&last)) = (values.first_chunk::<4>(), values.last_chunk::<4>()) else {
        return Err(missing);
    };
    let (four, six) = (T::from_u32(4), T::from_u32(6));
    let [p, q, r, s] = first;
    let at_begin = [quasi(p, q, r), quasi(q, r, s)];
    let [s, r, q, p] = last;
    let at_end = [quasi(p, q, r), quasi(q, r, s)];
    let Some(inner) = inner(values) else { return Err(missing) };
    let rows = inner.len();
    if let [row, ..] = inner {
        *row -= (at_begin[0] - at_begin[1]) * T::from_f64(1.0 / 6.0);
    }
    if let [.., row] = inner {
        *row -= (at_end[0] - at_end[1]) * T::from_f64(1.0 / 6.0);
    }
    // Forwards: what is left of each row when the unknown before is gone; backwards: the unknowns.
    let mut before = Vector3::from([T::ZERO; 3]);
    for (row, value) in inner.iter_mut().enumerate() {
        before = (*value * six - before) * T::from_f64(pivot(row, rows));
        *value = before;
    }
    let mut after = Vector3::from([T::ZERO; 3]);
    for (row, value) in inner.iter_mut().enumerate().rev() {
        after = *value - after * T::from_f64(pivot(row, rows));
        *value = after;
    }
    let second = |inner: Option<&Vector3<T>>, q: [Vector3<T>; 2]| match inner {
        Some(third) => third + (q[0] - q[1]),
        None => q[0],
    };
    let (one, other) = (second(inner.first(), at_begin), second(inner.last(), at_end));
    let (after_one, before_other) =
        (inner.first().copied().unwrap_or(other), inner.last().copied().unwrap_or(one));
    let outer = |p: Vector3<T>, one: Vector3<T>, two: Vector3<T>| p * six - one * four - two;
    let (begin, end) = (outer(first[1], one, after_one), outer(last[2], other, before_other));
    if let [a, b, .., c, d] = values {
        (*a, *b, *c, *d) = (begin, one, other, end);
    }
    Ok([outer(first[0], begin, one), outer(last[3], end, other)])
}

/// q − (p − 2q + r)/6
fn quasi<T: Real>(p: Vector3<T>, q: Vector3<T>, r: Vector3<T>) -> Vector3<T> {
    q - (p - q - (q - r)) * T::from_f64(1.0 / 6.0)
}

/// All but two at each end.
fn inner<V>(values: &mut [V]) -> Option<&mut [V]> {
    match values {
        [_, _, inner @ .., _, _] => Some(inner),
        _ => None,
    }
}

fn with_ends<'a, T: Real>(
    [before, after]: &'a [Vector3<T>; 2],
    inner: &'a [Vector3<T>],
) -> impl Iterator<Item = Vector3<T>> {
    core::iter::once(*before).chain(inner.iter().copied()).chain(core::iter::once(*after))
}

/// One over what is left on the diagonal (5, 4, …, 4, 5, or 6 where there is one row) when the unknown before is gone:
/// soon 2 − √3.
fn pivot(row: usize, rows: usize) -> f64 {
    const PIVOTS: [f64; 16] = {
        let mut pivots = [0.2; 16];
        let mut row = 1;
        while row < pivots.len() {
            pivots[row] = 1.0 / (4.0 - pivots[row - 1]);
            row += 1;
        }
        pivots
    };
    let pivot = PIVOTS.get(row).copied().unwrap_or(PIVOTS[15]);
    if row + 1 == rows { pivot / (1.0 + pivot) } else { pivot }
}

#[cfg(test)]
#[path = "interpolate_tests.rs"]
mod tests;
