//! The mean, its Jacobians, and its covariance.
//!
//! The errors are (φ, ν, π) of `with_jacobian`, whose past does not change with the motion. White noise is the same in
//! every direction, so a step's turn has the same covariance N_g²dt in all axes, and most of the 9×9 matrix needs no
//! number: cov(φ, φ) is a number times 1, cov(φ, ν) and cov(φ, π) are a vector each, in cross product. 28 numbers
//! instead of 81, and no product of matrices in a step. With the arms a, b of a step (see there), which is where the
//! noise of its turn acts, with g = N_g²dt and n = N_a²dt:
//!
//! - cov(φ, φ) += g
//! - cov(φ, ν) −= g[a]×; cov(φ, π) = cov(φ, π) + cov(φ, ν)dt − g[b]×
//! - cov(ν, ν) += g[a]×[a]×ᵀ + n
//! - cov(ν, π) = cov(ν, π) + cov(ν, ν)dt + g[a]×[b]×ᵀ + ½n dt
//! - cov(π, π) = cov(π, π) + (cov(ν, π) + cov(π, ν))dt + cov(ν, ν)dt² + g[b]×[b]×ᵀ + ⅓n dt²
//!
//! (all on the right as before the step). The terms of n are exact; those of g take the noise of a step as the step's
//! own, and err by a part in n² of n steps, as the midpoint rule does.

use super::{BiasJacobian, Biased, Covariance, NoiseDensities, WithJacobian};
use crate::delta::Delta;
use crate::integrate::Rule;
use crate::matrix::{Rows, add_scaled, matrix, rotation, skew, transposed_times, two_skews};
use crate::sample::Bias;
use crate::time::Step;
use crate::{Error, Real};
use nalgebra::{Quaternion, Vector3};

/// The [`Delta`] since the interval began, with its [`BiasJacobian`] and its [`Covariance`].
///
/// See the [module](super#covariance) for what is in the covariance and what is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithCovariance<T: Real, R> {
    linear: WithJacobian<T, R>,
    /// N² and K²
    densities: NoiseDensities<T>,
    gained: Gained<T>,
}

impl<T: Real, R: Rule<T>> WithCovariance<T, R>
where
    R::Input: Biased<T>,
{
    /// Begins where the rule does, which has seen the first sample *less this bias*: see
    /// [`Sample::minus`](crate::sample::Sample::minus).
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the field, where a density is not a number from 0 to 10⁶.
    pub fn new(rule: R, bias: Bias<T>, densities: &NoiseDensities<T>) -> Result<Self, Error> {
        let densities = densities.squared()?;
        Ok(Self { linear: WithJacobian::new(rule, bias), densities, gained: Gained::none() })
    }

    /// Takes the next input as the sensor gives it, bias and all, `dt` after the one before.
    #[inline]
    pub fn step(&mut self, input: &R::Input, dt: &Step<T>) {
        let arms = self.linear.advance(input, dt);
        let h = dt.seconds();
        let g = self.densities.gyro_noise_density * h;
        let n = self.densities.accel_noise_density * h;
        let (a, b) = (&arms.velocity, &arms.position);
        let (turned, moved) = (a * g, b * g);
        let gained = &mut self.gained;

        // The position before the velocity: it wants the old one.
        gained.position.add(h, &gained.velocity_position, &gained.velocity);
        gained.position.spread(b, &moved, n * h * h * T::from_f64(1.0 / 3.0));

        let velocity = gained.velocity.rows();
        let mut cross = add_scaled(&gained.velocity_position, h, &velocity);
        // [a]×[b]×ᵀ = (a·b) − b aᵀ
        cross = add_scaled(&cross, -g, &two_skews(a, b));
        let half = n * h * T::from_f64(0.5);
        cross[0].x += half;
        cross[1].y += half;
        cross[2].z += half;
        gained.velocity_position = cross;

        gained.velocity.spread(a, &turned, n);
        gained.turn_position += gained.turn_velocity * h + moved;
        gained.turn_velocity += turned;
        gained.turn += g;
    }

    /// The next interval: from the instant of the last input, with the bias that is now thought right.
    ///
    /// The rule keeps what it remembers, less the new bias in place of the old.
    pub fn restart(&mut self, bias: Bias<T>) {
        self.linear.restart(bias);
        self.gained = Gained::none();
    }

    /// The motion since the interval began.
    #[must_use]
    pub fn delta(&self) -> Delta<T> {
        self.linear.delta()
    }

    /// The bias that is taken out of all inputs, at which the Jacobians are.
    #[must_use]
    pub fn bias(&self) -> Bias<T> {
        self.linear.bias()
    }

    /// How the motion changes with the biases.
    #[must_use]
    pub fn jacobian(&self) -> BiasJacobian<T> {
        self.linear.jacobian()
    }

    /// The motion if the bias is this one, to first order: [`BiasJacobian::corrected`].
    #[must_use]
    pub fn corrected(&self, bias: &Bias<T>) -> Delta<T> {
        self.linear.corrected(bias)
    }

    /// Covariance of the motion by the white noise of both sensors: δθ = Rᵀφ, δv = ν − v×φ, δp = π − p×φ.
    #[must_use]
    pub fn covariance(&self) -> Covariance<T> {
        let mean = &self.linear.mean;
        self.gained.covariance(&mean.rotation, &mean.velocity, &mean.position)
    }

    /// By how much the gyroscope's bias has wandered since the interval began: variance of each axis, K_g² t,
    /// rad²/s².
    #[must_use]
    pub fn gyro_bias_variance(&self) -> T {
        self.densities.gyro_random_walk * self.delta().seconds
    }

    /// By how much the accelerometer's bias has wandered since the interval began: variance of each axis, K_a² t,
    /// m²/s⁴.
    #[must_use]
    pub fn accel_bias_variance(&self) -> T {
        self.densities.accel_random_walk * self.delta().seconds
    }
}

/// Covariances of (φ, ν, π), in the frame at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gained<T: Real> {
    /// cov(φ, φ) is this times 1.
    turn: T,
    /// cov(φ, ν) is −[this]×.
    turn_velocity: Vector3<T>,
    /// cov(φ, π) is −[this]×.
    turn_position: Vector3<T>,
    velocity: Symmetric<T>,
    velocity_position: Rows<T>,
    position: Symmetric<T>,
}

impl<T: Real> Gained<T> {
    fn none() -> Self {
        let zero = Vector3::from([T::ZERO; 3]);
        let nothing = Symmetric { diagonal: zero, beside: zero };
        Self {
            turn: T::ZERO,
            turn_velocity: zero,
            turn_position: zero,
            velocity: nothing,
            velocity_position: [zero; 3],
            position: nothing,
        }
    }

    /// Of (δθ, δv, δp) where the mean is this. Apart from the rule: compiled once for all of them.
    fn covariance(&self, q: &Quaternion<T>, v: &Vector3<T>, p: &Vector3<T>) -> Covariance<T> {
        let Self { turn: s, turn_velocity: a, turn_position: b, .. } = self;
        let (s, axes) = (*s, rotation(q));
        let turned = |arm: &Vector3<T>| matrix(&transposed_times(&axes, &skew(arm)));
        // cov(x − [y]φ, z − [w]φ), where cov(φ, x) = −[x_turn]× and cov(φ, z) = −[z_turn]×.
        let about = |x_z: &Rows<T>, y, x_turn, w, z_turn| {
            let sum = add_scaled(x_z, T::ONE, &two_skews(x_turn, w));
            let sum = add_scaled(&sum, T::ONE, &two_skews(y, z_turn));
            matrix(&add_scaled(&sum, -s, &two_skews(y, w)))
        };
        let zero = T::ZERO;
        Covariance {
            rotation: matrix(&[
                Vector3::new(s, zero, zero),
                Vector3::new(zero, s, zero),
                Vector3::new(zero, zero, s),
            ]),
            rotation_velocity: turned(&(v * s - a)),
            rotation_position: turned(&(p * s - b)),
            velocity: about(&self.velocity.rows(), v, a, v, a),
            velocity_position: about(&self.velocity_position, v, a, p, b),
            position: about(&self.position.rows(), p, b, p, b),
        }
    }
}

/// A symmetric 3×3 matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Symmetric<T: Real> {
    /// xx, yy, zz
    diagonal: Vector3<T>,
    /// yz, zx, xy
    beside: Vector3<T>,
}

impl<T: Real> Symmetric<T> {
    /// += (m + mᵀ)h + s h²
    #[inline(always)]
    fn add(&mut self, h: T, m: &Rows<T>, s: &Self) {
        let sums = Vector3::new(m[1].z + m[2].y, m[2].x + m[0].z, m[0].y + m[1].x);
        let twice = Vector3::new(m[0].x + m[0].x, m[1].y + m[1].y, m[2].z + m[2].z);
        self.diagonal += (twice + s.diagonal * h) * h;
        self.beside += (sums + s.beside * h) * h;
    }

    /// += \[arm\]×\[scaled\]×ᵀ + n, `scaled` being a multiple of `arm`
    #[inline(always)]
    fn spread(&mut self, arm: &Vector3<T>, scaled: &Vector3<T>, n: T) {
        let squares = Vector3::new(arm.x * scaled.x, arm.y * scaled.y, arm.z * scaled.z);
        self.diagonal += Vector3::new(
            squares.y + squares.z + n,
            squares.z + squares.x + n,
            squares.x + squares.y + n,
        );
        self.beside -= Vector3::new(arm.y * scaled.z, arm.z * scaled.x, arm.x * scaled.y);
    }

    #[inline(always)]
    fn rows(&self) -> Rows<T> {
        let (d, o) = (&self.diagonal, &self.beside);
        [Vector3::new(d.x, o.z, o.y), Vector3::new(o.z, d.y, o.x), Vector3::new(o.y, o.x, d.z)]
    }
}
