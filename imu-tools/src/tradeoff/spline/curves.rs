//! The curves that are compared: of which form, through what control points, in which numbers, cached or not.

use imu_core::se3::Pose;
use imu_core::spline::{
    Full, Knot, OneSided, ScrewKnot, Se3Spline, SplitSpline, SymmetricSplitSpline, TimeSymmetric,
    cache, cache_screws, interpolate, quasi_interpolant, quasi_interpolant_on_screws,
};
use imu_core::{Error, Real, nalgebra::Vector3};

/// Which curve runs through control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Positions, and beside them attitudes by the cumulative product.
    Plain,
    /// Positions, and beside them attitudes of the time-symmetric form.
    Symmetric,
    /// Positions and attitudes along screws.
    Coupled,
}

/// All of them, in the order of tables.
pub const FORMS: [Form; 3] = [Form::Plain, Form::Symmetric, Form::Coupled];

impl Form {
    /// What tables call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Symmetric => "symmetric",
            Self::Coupled => "SE(3)",
        }
    }
}

/// How control points are made of poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Not at all: the poses are taken for them, and the curve misses its poses.
    PosesThemselves,
    /// Each of three poses: what a stream can do.
    QuasiInterpolant,
    /// Of all poses, by a solve: the curve goes through every one.
    Interpolation,
}

/// All of them, in the order of tables.
pub const CONTROLS: [Control; 3] =
    [Control::PosesThemselves, Control::QuasiInterpolant, Control::Interpolation];

impl Control {
    /// What tables call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PosesThemselves => "poses as control points",
            Self::QuasiInterpolant => "quasi-interpolant",
            Self::Interpolation => "interpolation",
        }
    }

    /// Whether it is there for a form: nothing interpolates on SE(3).
    #[must_use]
    pub fn is_for(self, form: Form) -> bool {
        (form, self) != (Form::Coupled, Self::Interpolation)
    }

    /// Whether the curve comes near its poses.
    #[must_use]
    pub fn is_right(self) -> bool {
        self != Self::PosesThemselves
    }
}

/// In which numbers a curve is evaluated, and whether its logarithms are worked out beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// `f64`, of poses.
    F64,
    /// `f64`, of knots.
    F64Cached,
    /// `f32`, of poses rounded to it.
    F32,
    /// `f32`, of knots whose differences were formed in `f64`.
    F32Cached,
}

/// All of them, in the order of tables.
pub const NUMBERS: [Numbers; 4] =
    [Numbers::F64, Numbers::F64Cached, Numbers::F32, Numbers::F32Cached];

impl Numbers {
    /// What tables call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F64Cached => "f64, cached",
            Self::F32 => "f32",
            Self::F32Cached => "f32, cached",
        }
    }

    fn is_cached(self) -> bool {
        matches!(self, Self::F64Cached | Self::F32Cached)
    }
}

/// Poses at equal steps of a motion that went on before and goes on after the span asked for.
pub(super) struct Poses {
    /// The first one of the span.
    pub(super) start_ns: i64,
    pub(super) step_ns: u32,
    /// Of the span, and two more at each end.
    pub(super) all: Vec<Pose<f64>>,
}

/// How many poses there are beyond each end of the span.
pub(super) const BEYOND: usize = 2;

impl Poses {
    /// The control points of a curve that spans what is asked for; the first of one step before.
    pub(super) fn control(&self, form: Form, control: Control) -> Result<Points, Error> {
        let inner = |all: &[Pose<f64>], beyond: usize| {
            all.get(beyond..all.len().saturating_sub(beyond)).unwrap_or_default().to_vec()
        };
        let poses = match (control, form) {
            (Control::PosesThemselves, _) => inner(&self.all, BEYOND - 1),
            (Control::QuasiInterpolant, form) => {
                let of_three = match form {
                    Form::Coupled => quasi_interpolant_on_screws,
                    Form::Plain | Form::Symmetric => quasi_interpolant,
                };
                let threes = self.all.windows(3).filter_map(<[_]>::first_chunk);
                threes
                    .map(|[before, at, after]| of_three(before, at, after))
                    .collect::<Result<_, _>>()?
            }
            (Control::Interpolation, _) => {
                let through = inner(&self.all, BEYOND);
                let mut control = vec![Pose::identity(); through.len() + 2];
                let mut scratch = vec![Vector3::zeros(); through.len()];
                match form {
                    Form::Symmetric => {
                        interpolate::<_, TimeSymmetric>(&through, &mut control, &mut scratch)
                    }
                    _ => interpolate::<_, OneSided>(&through, &mut control, &mut scratch),
                }?;
                control
            }
        };
        Ok(Points {
            start_ns: self.start_ns - i64::from(self.step_ns),
            step_ns: self.step_ns,
            poses,
        })
    }
}

/// Control points and their instants.
pub(super) struct Points {
    start_ns: i64,
    step_ns: u32,
    poses: Vec<Pose<f64>>,
}

/// What is done with a curve, whichever it is.
pub(super) trait Use {
    type Out;

    /// With its full state at an instant.
    fn with<T: Real>(
        &mut self,
        full: impl Fn(i64) -> Result<Full<T>, Error>,
    ) -> Result<Self::Out, Error>;
}

impl Points {
    /// The same in the numbers of a curve.
    pub(super) fn stored(&self, form: Form, numbers: Numbers) -> Result<Stored, Error> {
        let made = match numbers {
            Numbers::F64 | Numbers::F64Cached => {
                Made::Double(Curves::of(&self.poses, form, numbers)?)
            }
            Numbers::F32 | Numbers::F32Cached => {
                Made::Single(Curves::of(&self.poses, form, numbers)?)
            }
        };
        Ok(Stored { start_ns: self.start_ns, step_ns: self.step_ns, form, made })
    }
}

/// Control points as an evaluation takes them.
pub(super) struct Stored {
    start_ns: i64,
    step_ns: u32,
    form: Form,
    made: Made,
}

enum Made {
    Double(Curves<f64>),
    Single(Curves<f32>),
}

enum Curves<T: Real> {
    Poses(Vec<Pose<T>>),
    Knots(Vec<Knot<T>>),
    Screws(Vec<ScrewKnot<T>>),
}

impl<T: Real> Curves<T> {
    fn of(poses: &[Pose<f64>], form: Form, numbers: Numbers) -> Result<Self, Error> {
        Ok(match (numbers.is_cached(), form) {
            (false, _) => Self::Poses(poses.iter().map(Pose::cast).collect()),
            (true, Form::Coupled) => {
                let mut screws = vec![ScrewKnot::default(); poses.len()];
                cache_screws(poses, &mut screws)?;
                Self::Screws(screws)
            }
            (true, _) => {
                let mut knots = vec![Knot::default(); poses.len()];
                cache(poses, &mut knots)?;
                Self::Knots(knots)
            }
        })
    }
}

impl Stored {
    /// Uses the curve.
    pub(super) fn used<U: Use>(&self, user: &mut U) -> Result<U::Out, Error> {
        match &self.made {
            Made::Double(curves) => self.used_in(curves, user),
            Made::Single(curves) => self.used_in(curves, user),
        }
    }

    fn used_in<T: Real, U: Use>(&self, curves: &Curves<T>, user: &mut U) -> Result<U::Out, Error> {
        let (start, step) = (self.start_ns, self.step_ns);
        match (curves, self.form) {
            (Curves::Poses(points), Form::Plain) => {
                let curve = SplitSpline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
            (Curves::Poses(points), Form::Symmetric) => {
                let curve = SymmetricSplitSpline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
            (Curves::Poses(points), Form::Coupled) => {
                let curve = Se3Spline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
            (Curves::Knots(points), Form::Symmetric) => {
                let curve = SymmetricSplitSpline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
            (Curves::Knots(points), _) => {
                let curve = SplitSpline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
            (Curves::Screws(points), _) => {
                let curve = Se3Spline::from_control_points(start, step, points)?;
                user.with(|t| curve.full(t))
            }
        }
    }
}
