//! A straightforward midpoint, as VINS-Mono (Qin, Li & Shen, 2018) has it, with plain arrays: what the rules are
//! measured beside.

/// A vector.
pub type V3 = [f64; 3];
/// A quaternion, w first.
pub type Q = [f64; 4];

fn product(a: Q, b: Q) -> Q {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

fn rotate(q: Q, v: V3) -> V3 {
    let cross = |a: V3, b: V3| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [q[1], q[2], q[3]];
    let t = cross(u, v).map(|x| 2.0 * x);
    let w = cross(u, t);
    [0, 1, 2].map(|k| v[k] + q[0] * t[k] + w[k])
}

/// Attitude, velocity, position; the sample before; biases.
struct Vins {
    q: Q,
    v: V3,
    p: V3,
    before: [V3; 2],
    bias: [V3; 2],
}

impl Vins {
    /// un_acc_0 = R(a₀ − b_a) − g, un_gyr = ½(ω₀ + ω₁) − b_g, q ← q (1, ½ un_gyr dt) normalised, and so on.
    fn step(&mut self, [rate, force]: [V3; 2], dt: f64) {
        const G: V3 = [0.0, 0.0, 9.81];
        let Self { q, v, p, before, bias } = self;
        let less = |a: V3, b: V3| [0, 1, 2].map(|k| a[k] - b[k]);
        let first = less(rotate(*q, less(before[1], bias[1])), G);
        let mean = [0, 1, 2].map(|k| 0.5 * (before[0][k] + rate[k]) - bias[0][k]);
        let turned = product(*q, [1.0, mean[0] * dt / 2.0, mean[1] * dt / 2.0, mean[2] * dt / 2.0]);
        let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
        *q = turned.map(|x| x / length);
        let second = less(rotate(*q, less(force, bias[1])), G);
        let felt = [0, 1, 2].map(|k| 0.5 * (first[k] + second[k]));
        *p = [0, 1, 2].map(|k| p[k] + dt * v[k] + 0.5 * dt * dt * felt[k]);
        *v = [0, 1, 2].map(|k| v[k] + dt * felt[k]);
        *before = [rate, force];
    }
}

/// From rest, through samples of rate and force `dt` seconds apart: attitude, velocity and position at the end.
#[inline(never)]
#[must_use]
pub fn run(first: [V3; 2], rest: &[[V3; 2]], dt: f64, bias: [V3; 2]) -> (Q, V3, V3) {
    let (q, v, p) = ([1.0, 0.0, 0.0, 0.0], [0.0; 3], [0.0; 3]);
    let mut state = Vins { q, v, p, before: first, bias };
    for input in rest {
        state.step(*input, dt);
    }
    (state.q, state.v, state.p)
}
