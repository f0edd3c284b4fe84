//! The whole of a three-axis sensor: one stage of each kind, or `()`, in the physical order.
//!
//! ```
//! use imu_core::noise::Sensor;
//! use imu_core::sensor::{Imperfections, Kinematics, LeverArm};
//! let beside = Imperfections {
//!     lever_arm: LeverArm { arm: [0.0, 0.1, 0.0] }, // m
//!     scale_misalignment: (),
//!     g_sensitivity: (),
//!     noise: [(); 3],
//!     bandwidth: [(); 3],
//!     saturation: (),
//!     quantisation: (),
//! };
//! let mut accelerometer = beside.accelerometer(0.005, 7, Sensor::ACCELEROMETER)?;
//! let mut motion = Kinematics { specific_force: [0.0, 0.0, 9.81], ..Kinematics::default() };
//! motion.angular_acceleration = [0.0, 0.0, 3.0];
//! let force: [f64; 3] = accelerometer.measure(&motion);
//! assert!((force[0] + 0.3).abs() < 1e-15); // α × r
//! # Ok::<(), imu_core::Error>(())
//! ```

use super::{AxisMap, ForceCoupling, Kinematics, Placement};
use crate::Error;
use crate::noise::{Normal, Sensor, Stage, Term, ThreeAxis};

/// What is wrong with a sensor: a value of each kind, or `()` where nothing is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfections<L = (), M = (), G = (), N = (), B = (), S = (), Q = ()> {
    /// Where it is: [`LeverArm`](super::LeverArm).
    pub lever_arm: L,
    /// What its axes read: [`ScaleMisalignment`](super::ScaleMisalignment).
    pub scale_misalignment: M,
    /// What a gyroscope reads of specific force: [`GSensitivity`](super::GSensitivity).
    pub g_sensitivity: G,
    /// Bias and noise of x, y, z: terms of [`noise`](crate::noise).
    pub noise: [N; 3],
    /// Low-pass of x, y, z: [`OnePole`](super::OnePole) or [`TwoPole`](super::TwoPole).
    pub bandwidth: [B; 3],
    /// Full scale of every axis: [`Saturation`](super::Saturation).
    pub saturation: S,
    /// Rounding of every axis: [`Quantisation`](crate::noise::Quantisation).
    pub quantisation: Q,
}

/// What each axis passes on its own: noise, bandwidth, saturation, quantisation.
type Chain<T, N, B, S, Q> =
    (<N as Term<T>>::Stage, <B as Term<T>>::Stage, <S as Term<T>>::Stage, <Q as Term<T>>::Stage);

impl<L, M, G, N, B, S, Q> Imperfections<L, M, G, N, B, S, Q> {
    /// A gyroscope of these imperfections for samples `dt` seconds apart.
    ///
    /// # Errors
    /// Those of the parts, naming the parameter at fault.
    #[expect(clippy::type_complexity, reason = "the type is the composition")]
    pub fn gyroscope<T: Normal>(
        self,
        dt: T,
        seed: u64,
        sensor: Sensor,
    ) -> Result<Gyroscope<L, M, G, Chain<T, N, B, S, Q>>, Error>
    where
        L: Placement<T>,
        M: AxisMap<T>,
        G: ForceCoupling<T>,
        N: Term<T>,
        B: Term<T>,
        S: Term<T> + Copy,
        Q: Term<T> + Copy,
    {
        self.lever_arm.check()?;
        self.scale_misalignment.check()?;
        self.g_sensitivity.check()?;
        let ([nx, ny, nz], [bx, by, bz]) = (self.noise, self.bandwidth);
        let (s, q) = (self.saturation, self.quantisation);
        let terms = [(nx, bx, s, q), (ny, by, s, q), (nz, bz, s, q)];
        Ok(Gyroscope {
            lever_arm: self.lever_arm,
            scale_misalignment: self.scale_misalignment,
            g_sensitivity: self.g_sensitivity,
            axes: ThreeAxis::prepare(terms, dt, seed, sensor)?,
        })
    }
}

impl<L, M, N, B, S, Q> Imperfections<L, M, (), N, B, S, Q> {
    /// An accelerometer of these imperfections for samples `dt` seconds apart.
    ///
    /// # Errors
    /// Those of the parts, naming the parameter at fault.
    #[expect(clippy::type_complexity, reason = "the type is the composition")]
    pub fn accelerometer<T: Normal>(
        self,
        dt: T,
        seed: u64,
        sensor: Sensor,
    ) -> Result<Accelerometer<L, M, Chain<T, N, B, S, Q>>, Error>
    where
        L: Placement<T>,
        M: AxisMap<T>,
        N: Term<T>,
        B: Term<T>,
        S: Term<T> + Copy,
        Q: Term<T> + Copy,
    {
        let Gyroscope { lever_arm, scale_misalignment, axes, .. } =
            self.gyroscope(dt, seed, sensor)?;
        Ok(Accelerometer { lever_arm, scale_misalignment, axes })
    }
}

/// A gyroscope at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroscope<L, M, G, A> {
    lever_arm: L,
    scale_misalignment: M,
    g_sensitivity: G,
    axes: ThreeAxis<A>,
}

impl<L, M, G, A> Gyroscope<L, M, G, A> {
    /// The reading of x, y, z, rad/s, in this `motion`; goes on to the next sample.
    #[inline(always)]
    pub fn measure<T: Normal>(&mut self, motion: &Kinematics<T>) -> [T; 3]
    where
        L: Placement<T>,
        M: AxisMap<T>,
        G: ForceCoupling<T>,
        A: Stage<T>,
    {
        let felt = self.lever_arm.felt(motion);
        let read = self.scale_misalignment.read(felt.angular_rate);
        self.axes.step(self.g_sensitivity.couple(read, felt.specific_force))
    }

    /// The bias that the *next* reading carries, before bandwidth and what follows it, rad/s.
    #[inline(always)]
    pub fn bias<T: Normal>(&self) -> [T; 3]
    where
        A: Stage<T>,
    {
        self.axes.bias()
    }
}

/// An accelerometer at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerometer<L, M, A> {
    lever_arm: L,
    scale_misalignment: M,
    axes: ThreeAxis<A>,
}

impl<L, M, A> Accelerometer<L, M, A> {
    /// The reading of x, y, z, m/s², in this `motion`; goes on to the next sample.
    #[inline(always)]
    pub fn measure<T: Normal>(&mut self, motion: &Kinematics<T>) -> [T; 3]
    where
        L: Placement<T>,
        M: AxisMap<T>,
        A: Stage<T>,
    {
        let felt = self.lever_arm.felt(motion);
        self.axes.step(self.scale_misalignment.read(felt.specific_force))
    }

    /// The bias that the *next* reading carries, before bandwidth and what follows it, m/s².
    #[inline(always)]
    pub fn bias<T: Normal>(&self) -> [T; 3]
    where
        A: Stage<T>,
    {
        self.axes.bias()
    }
}
