//! A damped oscillator over one sampling interval, exactly: what band vibration and the two-pole
//! low-pass share.
//!
//! ẍ + 2ζω₀ẋ + ω₀²x = 0 with u = ẋ/ω₀ moves (x, u) by Φ(dt) = exp(A dt), A = ω₀[0 1; −1 −2ζ]. For
//! ζ < 1, with ω_d = ω₀√(1 − ζ²), E = exp(−ζω₀dt), C = cos ω_d dt, S = (ω₀/ω_d) sin ω_d dt:
//! Φ = E[C + ζS, S; −S, C − ζS] (Meirovitch (2001), Fundamentals of Vibrations, section 2.1).

/// Φ − 1, row by row: an increment keeps its digits in `f32` when the interval is short.
pub(crate) struct Transition {
    pub(crate) xx: f64,
    pub(crate) xu: f64,
    pub(crate) ux: f64,
    pub(crate) uu: f64,
}

impl Transition {
    /// Over `angle` = ω₀ dt, at a damping ratio 0 < ζ < 1.
    pub(crate) fn new(angle: f64, damping: f64) -> Self {
        let root = libm::sqrt((1.0 - damping) * (1.0 + damping));
        let (sin, cos) = libm::sincos(root * angle);
        // E − 1 and C − 1 without cancellation.
        let fade = libm::expm1(-damping * angle);
        let half = libm::sin(0.5 * root * angle);
        let diagonal = fade * cos - 2.0 * half * half;
        let cross = (1.0 + fade) * sin / root;
        Self {
            xx: diagonal + damping * cross,
            xu: cross,
            ux: -cross,
            uu: diagonal - damping * cross,
        }
    }
}
