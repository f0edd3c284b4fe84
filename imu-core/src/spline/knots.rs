//! Uniform knots in integer nanoseconds: from an instant to the interval it is in, and how far along.
//!
//! Control point i belongs to the instant start + i·step. The curve on the interval from control point i to the next
//! takes control points i − 1 to i + 2, so N of them carry it from start + step to start + (N − 2)·step, both
//! included. No time is ever a floating-point number, and there is no division: any instant of ±292 years is exact.

use crate::{Error, Real};

/// Instants of control points: a beginning, a step, and how many.
///
/// ```
/// use imu_core::spline::Knots;
/// let knots = Knots::<f64>::new(1_000_000_000, 50_000_000, 10)?; // every 50 ms from the first second on
/// assert_eq!(knots.span(), (1_050_000_000, 1_400_000_000));
/// assert!(Knots::<f64>::new(0, 50_000_000, 3).is_err()); // a cubic needs four
/// # Ok::<(), imu_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knots<T: Real> {
    start_ns: i64,
    step_ns: u32,
    count: usize,
    /// (N − 2) steps, ns.
    last_ns: u64,
    /// ⌊(2⁶⁴ − 1)/step⌋
    reciprocal: u64,
    per_nanosecond: T,
    rate: T,
}

impl<T: Real> Knots<T> {
    /// The first control point at `start_ns`, then one every `step_ns`, `count` in all.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument: `step_ns` below 1, `count` below 4, or so large that the last
    /// instant is beyond `i64::MAX`.
    pub fn new(start_ns: i64, step_ns: u32, count: usize) -> Result<Self, Error> {
        let steps = count.checked_sub(4).ok_or(Error::OutOfRange("count"))?;
        let reciprocal =
            u64::MAX.checked_div(step_ns.into()).ok_or(Error::OutOfRange("step_ns"))?;
        let last = |steps: usize, more: u64| {
            u64::try_from(steps).ok()?.checked_add(more)?.checked_mul(step_ns.into())
        };
        let end = last(steps, 3).and_then(|length| start_ns.checked_add_unsigned(length));
        match (end, last(steps, 2)) {
            (Some(_), Some(last_ns)) => Ok(Self {
                start_ns,
                step_ns,
                count,
                last_ns,
                reciprocal,
                per_nanosecond: T::from_f64(1.0 / f64::from(step_ns)),
                rate: T::from_f64(1e9 / f64::from(step_ns)),
            }),
            _ => Err(Error::OutOfRange("count")),
        }
    }

    /// The same, beginning at another instant.
    #[inline]
    pub(super) fn moved_to(self, start_ns: i64) -> Self {
        Self { start_ns, ..self }
    }

    /// The instant of the first control point, ns.
    #[must_use]
    pub fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// The time between control points, ns.
    #[must_use]
    pub fn step_ns(&self) -> u32 {
        self.step_ns
    }

    /// How many control points there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Control points a second: 1/h, 1/s.
    #[must_use]
    #[inline]
    pub fn rate(&self) -> T {
        self.rate
    }

    /// The first and the last instant at which there is a curve, ns.
    #[must_use]
    pub fn span(&self) -> (i64, i64) {
        let at = |elapsed| self.start_ns.saturating_add_unsigned(elapsed);
        (at(self.step_ns.into()), at(self.last_ns))
    }

    /// The interval of an instant, from 1 on, and how far along it is, from 0 to 1.
    #[inline(always)]
    pub(crate) fn locate(&self, t_ns: i64) -> Result<Place<T>, Error> {
        let elapsed = (t_ns as u64).wrapping_sub(self.start_ns as u64);
        let step = u64::from(self.step_ns);
        if t_ns < self.start_ns || elapsed < step || elapsed > self.last_ns {
            return Err(Error::OutOfRange("t_ns"));
        }
        // At most one too small: the reciprocal is less than 1 below 2⁶⁴/step, so its product less than 1 below.
        let mut interval = high_of_product(elapsed, self.reciprocal);
        let mut rest = elapsed.wrapping_sub(interval.wrapping_mul(step));
        if rest >= step {
            interval = interval.wrapping_add(1);
            rest = rest.wrapping_sub(step);
        }
        if elapsed == self.last_ns {
            // The end belongs to the last interval.
            interval = interval.wrapping_sub(1);
            rest = step;
        }
        let u = match u32::try_from(rest) {
            Ok(rest) => T::from_u32(rest) * self.per_nanosecond,
            Err(_) => T::ONE,
        };
        Ok(Place { interval: interval as usize, u })
    }

    /// The same `offset_s` seconds after that instant.
    #[inline]
    pub(crate) fn locate_between(&self, t_ns: i64, offset_s: T) -> Result<Place<T>, Error> {
        let offset = offset_s.to_f64() * 1e9;
        let whole = Real::round_ties_even(offset);
        if Real::abs(whole) < 9e18 {
            let t_ns = t_ns.checked_add(whole as i64).ok_or(Error::OutOfRange("t_ns"))?;
            let place = self.locate(t_ns)?;
            Ok(Place { u: place.u + T::from_f64(offset - whole) * self.per_nanosecond, ..place })
        } else {
            Err(Error::OutOfRange("offset_s"))
        }
    }
}

/// Where an instant is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place<T> {
    interval: usize,
    /// 0 at its beginning, 1 at its end.
    pub(crate) u: T,
}

impl<T> Place<T> {
    /// The four control points that act.
    #[inline(always)]
    pub(crate) fn window<'a, C>(&self, points: &'a [C]) -> Result<&'a [C; 4], Error> {
        self.interval
            .checked_sub(1)
            .and_then(|first| points.get(first..))
            .and_then(<[C]>::first_chunk)
            .ok_or(Error::OutOfRange("t_ns"))
    }
}

/// The upper half of a product of 64 bits by 64, of four products of 32 by 32: what a Cortex-M has.
#[inline(always)]
fn high_of_product(a: u64, b: u64) -> u64 {
    let halves = |x: u64| (x >> 32, x & 0xffff_ffff);
    let ((a1, a0), (b1, b0)) = (halves(a), halves(b));
    // None of these sums reaches 2⁶⁴: (2³² − 1)² + 2(2³² − 1) = 2⁶⁴ − 1.
    let low = a0.wrapping_mul(b0) >> 32;
    let (m1, m0) = halves(a1.wrapping_mul(b0).wrapping_add(low));
    let middle = a0.wrapping_mul(b1).wrapping_add(m0) >> 32;
    a1.wrapping_mul(b1).wrapping_add(m1).wrapping_add(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn products_are_those_of_128_bits(a: u64, b: u64) {
            prop_assert_eq!(high_of_product(a, b), ((u128::from(a) * u128::from(b)) >> 64) as u64);
        }

        /// Beside division in 128 bits, from end to end of the range.
        #[test]
        fn places_are_exact(start: i64, step in 1..u32::MAX, count in 4_usize..1_000_000, at in 0.0..1.0) {
            let Ok(knots) = Knots::<f64>::new(start, step, count) else { return Ok(()) };
            let (first, last) = knots.span();
            let step = i128::from(step);
            for t in [first, first + 1, last, last - 1, first + ((last - first) as f64 * at) as i64] {
                let elapsed = i128::from(t) - i128::from(start);
                let interval = (elapsed / step).min(count as i128 - 3);
                let place = knots.locate(t).unwrap();
                prop_assert_eq!(place.interval as i128, interval);
                let u = (elapsed - interval * step) as f64 / step as f64;
                prop_assert!((place.u - u).abs() < 3e-16);
            }
            prop_assert!(knots.locate(first - 1).is_err());
            prop_assert!(last == i64::MAX || knots.locate(last + 1).is_err());
            for t in [i64::MIN, i64::MAX] {
                prop_assert_eq!(knots.locate(t).is_ok(), first <= t && t <= last);
            }
        }
    }

    #[test]
    fn between_nanoseconds_and_across_knots() {
        let knots = Knots::<f64>::new(0, 1000, 8).unwrap();
        let place = knots.locate_between(1500, 1e-6 + 0.25e-9).unwrap();
        assert_eq!(place.interval, 2);
        assert!((place.u - 0.50025).abs() < 1e-12);
        for offset in [f64::NAN, f64::INFINITY, 1e300, 5e-6, -1e-6] {
            assert!(knots.locate_between(1500, offset).is_err(), "{offset}");
        }
        assert!(knots.locate_between(i64::MAX, 1.0).is_err());
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert_eq!(Knots::<f32>::new(0, 0, 4), Err(Error::OutOfRange("step_ns")));
        assert_eq!(Knots::<f32>::new(0, 1, 3), Err(Error::OutOfRange("count")));
        assert_eq!(Knots::<f32>::new(0, 1, usize::MAX), Err(Error::OutOfRange("count")));
        assert!(Knots::<f32>::new(i64::MAX - 3, 1, 4).is_ok());
        assert!(Knots::<f32>::new(i64::MAX - 2, 1, 4).is_err());
        let all = Knots::<f64>::new(i64::MIN, u32::MAX, 1 << 32).unwrap();
        assert!(all.locate(i64::MAX - (1 << 34)).is_ok());
    }
}
