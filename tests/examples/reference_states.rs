//! Integrates the samples that the course program `vio_data_simulation` (He & Gao, 2019) wrote by the textbook rules, and
//! compares with the states that it wrote, row by row.
//!
//! `cargo run --release -p imu-tests --example reference_states -- FOLDER`, with `truth_imu_clean_200hz.csv` (t, q_wxyz,
//! p, v, gyroscope, accelerometer; 17 digits), `euler_orig_200hz.csv` and `midpoint_homework_200hz.csv` (t, q_wxyz, p, v)
//! of it in the folder. Ends with 1 where a number is off by more than 1e-9 of the length of its vector.

use std::path::Path;
use std::process::ExitCode;

use imu_core::State;
use imu_core::integrate::{Rule, TextbookEuler, TextbookMidpoint};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::Sample;
use imu_core::time::Step;
use imu_core::world::Flat;

/// Rows of numbers, without the header.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let numbers =
        |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    text.lines().skip(1).map(numbers).collect()
}

fn vector(row: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(row[at], row[at + 1], row[at + 2])
}

fn norm(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

/// The largest difference from the states of a file, over the length of their vectors.
fn worst(
    samples: &[Vec<f64>],
    states: &[Vec<f64>],
    mut rule: impl Rule<f64, Input = Sample<f64>>,
) -> f64 {
    let first = &samples[0];
    let q = Quaternion::new(first[1], first[2], first[3], first[4]);
    let mut state = State::new(q, vector(first, 8), vector(first, 5)).expect("a state");
    let world = Flat::new(Vector3::new(0.0, 0.0, -9.81)).expect("gravity");
    let dt = Step::from_nanoseconds(5_000_000).expect("200 Hz");
    let mut worst: f64 = 0.0;
    for (row, wanted) in samples.iter().zip(states).skip(1) {
        let sample = Sample::new(vector(row, 11), vector(row, 14)).expect("finite");
        state.advance(&mut rule, &sample, &dt, &world);
        let q = state.attitude_wb().coords;
        let sign = if q.w * wanted[1] < 0.0 { -1.0 } else { 1.0 };
        let [w, x, y, z] =
            [(q.w, 1), (q.x, 2), (q.y, 3), (q.z, 4)].map(|(c, k)| sign * c - wanted[k]);
        let (position, velocity) = (vector(wanted, 5), vector(wanted, 8));
        worst = worst
            .max(w.hypot(x).hypot(y).hypot(z))
            .max(norm(state.position_w() - position) / norm(position))
            .max(norm(state.velocity_w() - velocity) / norm(velocity));
    }
    worst
}

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("usage: reference_states FOLDER");
        return ExitCode::from(2);
    };
    let read = |name: &str| rows(&Path::new(&folder).join(name));
    let samples = read("truth_imu_clean_200hz.csv");
    let first = Sample::new(vector(&samples[0], 11), vector(&samples[0], 14)).expect("finite");
    let euler = worst(&samples, &read("euler_orig_200hz.csv"), TextbookEuler);
    let midpoint =
        worst(&samples, &read("midpoint_homework_200hz.csv"), TextbookMidpoint::new(&first));
    println!("largest relative difference of a state: Euler {euler:.1e}, midpoint {midpoint:.1e}");
    if euler.max(midpoint) <= 1e-9 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
