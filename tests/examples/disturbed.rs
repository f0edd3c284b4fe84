//! How well N and K come out of records that were handled, bumped, cut and warming up.
//!
//! `cargo run --release -p imu-tests --example disturbed -- [SEEDS] [CASES]` (200 seeds, all cases): 2 h at 200 Hz of
//! the mid preset, both sensors, three axes: handling at both ends, a bump that tilts the sensor, 1 %
//! loss, a hole of a minute, a clock step of 1 s and a warm-up of ten minutes; then each by itself,
//! a ramp over all of the record, and nothing of it.

use imu_core::allan::Parameter;
use imu_tests::disturbed::{Disturbances, Disturbed};
use imu_tools::calibrate::{Options, SensorNoise, calibrate};
use imu_tools::scene::{Preset, Scene, Simulator};

const LENGTH_S: f64 = 7200.0;

/// What came out of one sensor over all seeds.
#[derive(Default)]
struct Tally {
    records: u32,
    /// Relative errors of N of each axis; K of each axis and pooled: whether its interval holds it.
    n: Vec<f64>,
    axes: (u32, u32),
    pooled: (u32, u32),
    left_out_s: f64,
    warmed_up: u32,
    ramps: u32,
}

impl Tally {
    fn take(&mut self, sensor: &SensorNoise, n: f64, k: f64) {
        self.records += 1;
        self.left_out_s += sensor.disturbed.iter().map(|s| s.to_s - s.from_s).sum::<f64>();
        self.warmed_up += u32::from(sensor.warm_up_s.is_some());
        self.ramps += u32::from(sensor.ramp.is_some());
        let holds = |p: Parameter| match p {
            Parameter::Observable { low90, high90, .. } => low90 <= k && k <= high90,
            Parameter::NotObservable { upper90, .. } => k <= upper90,
        };
        for axis in &sensor.axes {
            if let Parameter::Observable { value, .. } = axis.noise_density {
                self.n.push(value / n - 1.0);
            }
            self.axes.0 += u32::from(holds(axis.random_walk));
            self.axes.1 += 1;
        }
        self.pooled.0 += u32::from(holds(sensor.pooled.random_walk));
        self.pooled.1 += 1;
    }

    fn print(&self, name: &str) {
        let worst = self.n.iter().fold(0.0_f64, |worst, e| worst.max(e.abs()));
        let rms = (self.n.iter().map(|e| e * e).sum::<f64>() / self.n.len() as f64).sqrt();
        let share = |(held, of): (u32, u32)| 100.0 * f64::from(held) / f64::from(of);
        let sd = |(_, of): (u32, u32)| 30.0 / f64::from(of).sqrt();
        println!(
            "  {name:14} N rms {:.3} %, worst {:.3} %; K within its 90 % interval: axes {:.1} ± {:.1} %, \
             pooled {:.1} ± {:.1} %; left out {:.0} s; warm-up seen in {} of {}, ramp in {}",
            100.0 * rms,
            100.0 * worst,
            share(self.axes),
            sd(self.axes),
            share(self.pooled),
            sd(self.pooled),
            self.left_out_s / f64::from(self.records),
            self.warmed_up,
            self.records,
            self.ramps,
        );
    }
}

fn run(name: &str, what: Disturbances, seeds: u64, options: Options) {
    let (mut gyroscope, mut accelerometer) = (Tally::default(), Tally::default());
    for seed in 0..seeds {
        let scene = Scene { duration_ns: (LENGTH_S * 1e9) as u64, seed, ..Preset::Mid.scene() };
        let simulator = Simulator::new(&scene).expect("a valid scene");
        let source = Disturbed::new(simulator, what, LENGTH_S, seed + 1);
        let calibration =
            calibrate(Box::new(source), name, &options, |_| {}).expect("a record to calibrate");
        if let Some(sensor) = &calibration.gyroscope {
            gyroscope.take(sensor, 0.015, 5e-5);
        }
        if let Some(sensor) = &calibration.accelerometer {
            accelerometer.take(sensor, 0.019, 5e-4);
        }
    }
    println!("{name}");
    gyroscope.print("gyroscope");
    accelerometer.print("accelerometer");
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<usize>().expect("a number"));
    let seeds = arguments.next().unwrap_or(200) as u64;
    let all = Disturbances::all(LENGTH_S);
    let none = Disturbances::default();
    let options = Options::default();
    let cases = [
        ("everything", all, options),
        ("nothing", none, options),
        ("handled at both ends", Disturbances { handled_s: all.handled_s, ..none }, options),
        ("bumped", Disturbances { bump_at_s: all.bump_at_s, ..none }, options),
        ("warm-up", Disturbances { warm_up_s: all.warm_up_s, ..none }, options),
        ("ramp", Disturbances { ramp_per_hour: 0.05, ..none }, options),
        ("everything, --keep-all", all, Options { keep_all: true, ..options }),
    ];
    let wanted = arguments.next().unwrap_or(cases.len());
    for (name, what, options) in cases.into_iter().take(wanted) {
        run(name, what, seeds, options);
    }
}
