//! Means of the terms that draw no random number: the same terms with other parameters.
//!
//! The mean of R·t over the interval that ends at t is R·(t − dt/2); of A sin(2πft + φ) it is
//! A·(sin πf dt/(πf dt)) sin(2πft + φ − πf dt); of e^(−t/t_c) it is e^(−t/t_c)·(eˣ − 1)/x, x = dt/t_c.

use super::IntervalMean;
use crate::noise::{
    Channel, ConstantBias, Normal, RateRamp, RateRampStage, Sinusoid, SinusoidStage,
    TemperatureRamp, Term, WarmUp, WarmUpStage, finite, interval, positive,
};
use crate::{Error, Real};
use core::f64::consts::PI;

impl<T: Normal> Term<T> for IntervalMean<RateRamp<T>> {
    type Stage = (ConstantBias<T>, RateRampStage<T>);

    fn prepare(self, dt: T, channel: Channel) -> Result<Self::Stage, Error> {
        let late = finite("rate_ramp", self.0.rate_ramp)? * interval(dt)? * T::from_f64(-0.5);
        let late = ConstantBias { constant_bias: finite("rate_ramp * dt", late)? };
        Ok((late.prepare(dt, channel)?, self.0.prepare(dt, channel)?))
    }
}

impl<T: Normal> Term<T> for IntervalMean<TemperatureRamp<T>> {
    type Stage = (ConstantBias<T>, RateRampStage<T>);

    fn prepare(self, dt: T, channel: Channel) -> Result<Self::Stage, Error> {
        let rate = finite("rate", self.0.rate)?;
        let start = self.0.start - T::from_f64(0.5) * rate * interval(dt)?;
        TemperatureRamp { start, ..self.0 }.prepare(dt, channel)
    }
}

impl<T: Normal> Term<T> for IntervalMean<WarmUp<T>> {
    type Stage = WarmUpStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<WarmUpStage<T>, Error> {
        let time = positive("time_constant", self.0.time_constant)?;
        let x = positive("dt / time_constant", interval(dt)? / time)?;
        let rise = finite("rise * exp(dt / time_constant)", self.0.rise * (x.exp_m1() / x))?;
        let start = self.0.start + (self.0.rise - rise);
        WarmUp { start, rise, ..self.0 }.prepare(dt, channel)
    }
}

impl<T: Normal> Term<T> for IntervalMean<Sinusoid<T>> {
    type Stage = SinusoidStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<SinusoidStage<T>, Error> {
        let half = PI * finite("frequency", self.0.frequency)?.to_f64() * interval(dt)?.to_f64();
        let gain = if half > 0.0 { libm::sin(half) / half } else { 1.0 };
        // A negative amplitude is the other phase.
        let turned = if gain < 0.0 { PI } else { 0.0 };
        Sinusoid {
            amplitude: self.0.amplitude * T::from_f64(Real::abs(gain)),
            frequency: self.0.frequency,
            phase: T::from_f64(self.0.phase.to_f64() - half + turned),
        }
        .prepare(dt, channel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::{Axis, Sensor, Stage};
    use proptest::prelude::*;

    const FINE: u32 = 512;

    fn channel() -> Channel {
        Channel::new(1, Sensor::GYROSCOPE, Axis::X)
    }

    /// The mean that the samples at the middles of `FINE` pieces have over the first interval from 0 to
    /// `dt`: right within (dt/`FINE`)²/24 of the second derivative.
    fn fine<P: Term<f64>>(term: P, dt: f64) -> f64 {
        let piece = dt / f64::from(FINE);
        let mut stage = term.prepare(0.5 * piece, channel()).unwrap();
        let mut sum = 0.0;
        for _ in 0..FINE {
            stage.step(0.0);
            sum += stage.step(0.0);
        }
        sum / f64::from(FINE)
    }

    /// The second sample of the term's mean, that of the interval from 0 to `dt`.
    fn mean<P>(term: P, dt: f64) -> f64
    where
        IntervalMean<P>: Term<f64>,
    {
        let mut stage = IntervalMean(term).prepare(dt, channel()).unwrap();
        stage.step(0.0);
        stage.step(0.0)
    }

    proptest! {
        #[test]
        fn each_is_the_mean_of_fine_samples(
            a in -2.0_f64..2.0, b in -2.0_f64..2.0, dt in 0.01_f64..1.0, f in 0.0_f64..5.0,
            time in 0.5_f64..5.0,
        ) {
            let ramp = RateRamp { rate_ramp: a };
            prop_assert!((mean(ramp, dt) - fine(ramp, dt)).abs() < 1e-12);
            let ramp = TemperatureRamp { coefficient: a, start: b, rate: 0.7 };
            prop_assert!((mean(ramp, dt) - fine(ramp, dt)).abs() < 1e-12);
            // (1/512)²/24 · 4/0.25.
            let warm_up = WarmUp { coefficient: a, start: b, rise: b, time_constant: time };
            prop_assert!((mean(warm_up, dt) - fine(warm_up, dt)).abs() < 3e-6);
            // (1/512)²/24 · (2π5)².
            let line = Sinusoid { amplitude: 1.0, frequency: f, phase: a };
            prop_assert!((mean(line, dt) - fine(line, dt)).abs() < 2e-4);
        }
    }
}
