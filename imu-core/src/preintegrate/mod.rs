//! Preintegration: all samples between two frames as one [`Delta`](crate::delta::Delta), with what an estimator needs
//! beside it.
//!
//! | type | what it keeps |
//! | --- | --- |
//! | [`Mean`] | the delta |
//! | [`WithJacobian`] | and how it changes with the biases, so that a new bias needs no second pass over the samples |
//! | [`WithCovariance`] | and its covariance by the sensors' white noise |
//!
//! After Forster, Carlone, Dellaert & Scaramuzza (2017), "On-manifold preintegration for real-time visual-inertial
//! odometry", with the errors propagated in the coordinates of Barrau & Bonnabel (2020), "A mathematical framework for
//! IMU error propagation with applications to preintegration".
//!
//! ```
//! use imu_core::integrate::Midpoint;
//! use imu_core::nalgebra::Vector3;
//! use imu_core::preintegrate::{NoiseDensities, WithCovariance};
//! use imu_core::sample::{Bias, Sample};
//! use imu_core::so3;
//! use imu_core::time::Step;
//!
//! // 20 samples at 200 Hz between two camera frames, of a body that turns to the left on a bend.
//! let dt = Step::from_nanoseconds(5_000_000)?;
//! let sample = Sample::new(Vector3::new(0.0, 0.0, 0.52), Vector3::new(0.0, 1.0, 9.81))?;
//! let bias = Bias::new(Vector3::new(0.0, 0.0, 0.02), Vector3::zeros())?;
//! let noise = NoiseDensities {
//!     gyro_noise_density: 1e-3,  // rad/s/√Hz
//!     accel_noise_density: 1e-2, // m/s²/√Hz
//!     gyro_random_walk: 1e-5,    // rad/s²/√Hz
//!     accel_random_walk: 1e-4,   // m/s³/√Hz
//! };
//! let first = Midpoint::new(&sample.minus(&bias));
//! let mut between = WithCovariance::new(first, bias, &noise)?;
//! for _ in 0..20 {
//!     between.step(&sample, &dt);
//! }
//! let turned = |delta: &imu_core::delta::Delta<f64>| so3::log(&delta.rotation()).z;
//! assert!((turned(&between.delta()) - 0.5 * 0.1).abs() < 1e-12);
//! // The optimiser finds another bias: no need to go through the samples again.
//! let better = Bias::new(Vector3::new(0.0, 0.0, 0.03), Vector3::zeros())?;
//! assert!((turned(&between.corrected(&better)) - 0.49 * 0.1).abs() < 1e-12);
//! // Weights of the factor: N_g²t, and so on.
//! assert!((between.covariance().rotation[(0, 0)] - 1e-6 * 0.1).abs() < 1e-18);
//! assert!((between.accel_bias_variance() - 1e-8 * 0.1).abs() < 1e-20);
//! // On to the next pair of frames.
//! between.restart(better);
//! assert_eq!(between.delta().nanoseconds(), 0);
//! # Ok::<(), imu_core::Error>(())
//! ```
//!
//! # Frames
//!
//! A delta is seen from the body at the first frame, and knows nothing of gravity. With the states of both frames in the
//! world (R₁, v₁, p₁; R₂, v₂, p₂), gravity g and the time t between them, a factor's residual is (Forster et al., eq. (45)):
//! Log(Rᵀ R₁ᵀR₂), R₁ᵀ(v₂ − v₁ − g t) − v, R₁ᵀ(p₂ − p₁ − v₁t − ½g t²) − p; in this order and with these signs the
//! [`Covariance`] is the residual's.
//!
//! # Jacobians
//!
//! They are the derivatives of [`Midpoint`](crate::integrate::Midpoint), exactly, also of the first step after a
//! [`restart`](Mean::restart). Of any other rule they are right to first order: see the figures at [`BiasJacobian`].
//! Increments serve as well as samples. A step must turn by less than π.
//!
//! # Covariance
//!
//! [`Covariance`] is that of (δθ, δv, δp) by white noise of densities N_g and N_a: n samples of standard deviation
//! N/√dt are n independent numbers, one a step, N²dt. A rule averages two neighbours, but neighbouring steps share a
//! sample, so its two halves come together again. To take the two ends of every step as independent of those of the
//! next, as a well-known estimator does, halves the variance: the deviation is 0.71 of the truth. (Of the samples at the
//! two ends of the interval half belongs to the neighbours. What is here is right for a chain of intervals; in one
//! alone the variance is less by a part in 2n.)
//!
//! Not in it is the wandering of the biases within the interval. It adds to the variances of rotation and velocity
//! K²t³/3, which is (K t/N)²/3 of them: one in 30 000 for K/N = 0.01/s and a second. How far the biases have wandered
//! at the end is given apart, for the factor between the biases of two frames:
//! [`gyro_bias_variance`](WithCovariance::gyro_bias_variance) and
//! [`accel_bias_variance`](WithCovariance::accel_bias_variance).
//!
//! # Cost
//!
//! No trigonometry, root or division in a step that turns by less than 0.7 rad, beyond what the rule does.

mod biased;
mod concrete;
mod covariance;
mod jacobian;
mod mean;
mod turn;
mod with_covariance;
mod with_jacobian;

pub use biased::Biased;
pub use concrete::{double, single};
pub use covariance::{Covariance, NoiseDensities};
pub use jacobian::BiasJacobian;
pub use mean::Mean;
pub use with_covariance::WithCovariance;
pub use with_jacobian::WithJacobian;

#[cfg(test)]
mod monte_carlo;
#[cfg(test)]
mod tests;
