//! Records of white noise at 100 Hz, disturbed in ways whose place is known.

use super::*;
use crate::calibrate::SensorKind;
use crate::calibrate::limits::Limits;

const RATE: usize = 100;

/// White noise of standard deviation 1, always the same (the sum of twelve uniforms).
fn noise(n: usize) -> Vec<[f64; 3]> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n).map(|_| [(); 3].map(|()| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect()
}

/// What came out: values and gaps in order, and where it was disturbed.
#[derive(Default)]
struct Outcome {
    values: usize,
    missing: u64,
    restarts: usize,
    stretches: Vec<Stretch>,
}

fn run(pieces: &[Event<'_>], keep_all: bool) -> Outcome {
    let mut outcome = Outcome::default();
    let mut stillness = Stillness::new(keep_all);
    let mut take = |event: Event<'_>| match event {
        Event::Values(values) => outcome.values += values.len(),
        Event::Missing(n) => outcome.missing += n,
        Event::Restart => outcome.restarts += 1,
    };
    let limits = Limits::of(SensorKind::Gyroscope, &noise(1000));
    for piece in pieces {
        match piece {
            Event::Values(values) => {
                for part in values.chunks(777) {
                    stillness.take(Event::Values(part), 0.01, Some(limits), &mut take);
                }
            }
            event => stillness.take(*event, 0.01, Some(limits), &mut take),
        }
    }
    outcome.stretches = stillness.finish(&mut take);
    outcome
}

/// Disturbs the samples of some seconds.
fn during(values: &mut [[f64; 3]], seconds: std::ops::Range<usize>, change: impl Fn(f64) -> f64) {
    for (k, value) in values.iter_mut().enumerate() {
        if seconds.contains(&(k / RATE)) {
            value[1] += change(k as f64 / RATE as f64);
        }
    }
}

#[test]
fn noise_passes_whole_and_in_order() {
    for seconds in [0, 1, 10, 100, 300, 3000] {
        let values = noise(seconds * RATE + 37);
        let outcome = run(&[Event::Values(&values)], false);
        assert_eq!((outcome.values, outcome.missing, outcome.restarts), (values.len(), 0, 0));
        assert!(outcome.stretches.is_empty(), "{:?}", outcome.stretches);
    }
}

#[test]
fn gaps_and_restarts_pass() {
    let values = noise(400 * RATE);
    let (a, b) = values.split_at(15_013);
    let events = [
        Event::Values(a),
        Event::Missing(3),
        Event::Values(b),
        Event::Missing(1_000_000),
        Event::Values(a),
        Event::Restart,
        Event::Values(b),
    ];
    let outcome = run(&events, false);
    assert_eq!(outcome.values, 2 * values.len());
    assert_eq!((outcome.missing, outcome.restarts), (1_000_003, 1));
}

/// Handled at both ends: what is left out begins and ends within three windows of the one that it
/// begins or ends in.
#[test]
fn handling_at_both_ends_is_left_out() {
    let mut values = noise(1000 * RATE);
    during(&mut values, 0..20, |t| 5.0 * (4.0 * t).sin());
    during(&mut values, 985..1000, |t| 5.0 * (4.0 * t).sin());
    let outcome = run(&[Event::Values(&values)], false);
    let [first, last] = outcome.stretches[..] else { panic!("{:?}", outcome.stretches) };
    let near = 4 * window(RATE as f64) as u64;
    assert!(first.from == 0 && (2000..=2000 + near).contains(&first.to), "{first:?}");
    assert!((98_500 - near..=98_500).contains(&last.from) && last.to == 100_000, "{last:?}");
    let left_out = first.to + last.to - last.from;
    assert_eq!(outcome.values as u64 + left_out, 100_000);
    assert_eq!(outcome.restarts, 1); // before the first sample that counts
}

/// A vibration that doubles the variance: a second of it goes unseen, twenty do not.
#[test]
fn a_truck_becomes_missing_time() {
    let mut values = noise(1000 * RATE);
    during(&mut values, 500..520, |t| std::f64::consts::SQRT_2 * (170.0 * t).sin());
    let outcome = run(&[Event::Values(&values)], false);
    let [truck] = outcome.stretches[..] else { panic!("{:?}", outcome.stretches) };
    assert!((49_000..=50_300).contains(&truck.from), "{truck:?}");
    assert!((51_700..=53_000).contains(&truck.to), "{truck:?}");
    assert_eq!((outcome.missing, outcome.restarts), (truck.to - truck.from, 0));
    assert_eq!(outcome.values as u64 + outcome.missing, 100_000);
}

/// A bump after which the sensor stands otherwise: no difference may span it.
#[test]
fn a_tilt_is_a_restart() {
    let mut values = noise(1000 * RATE);
    during(&mut values, 500..501, |t| 10.0 * (60.0 * t).sin());
    during(&mut values, 501..1000, |_| 0.3); // 17 standard deviations of 32 s
    let outcome = run(&[Event::Values(&values)], false);
    assert_eq!((outcome.stretches.len(), outcome.missing, outcome.restarts), (1, 0, 1));
}

/// A sensor that is set down gently elsewhere: nothing but a step of the mean.
#[test]
fn a_step_alone_is_seen() {
    let mut values = noise(1000 * RATE);
    during(&mut values, 500..1000, |_| 2.0);
    let outcome = run(&[Event::Values(&values)], false);
    assert_eq!((outcome.stretches.len(), outcome.restarts), (1, 1));
}

#[test]
fn keep_all_tells_and_keeps() {
    let mut values = noise(1000 * RATE);
    during(&mut values, 0..20, |t| 5.0 * (4.0 * t).sin());
    let outcome = run(&[Event::Values(&values)], true);
    assert_eq!((outcome.values, outcome.missing, outcome.restarts), (values.len(), 0, 0));
    assert_eq!(outcome.stretches.len(), 1);
}

/// Half of the first minutes and half of the rest is motion: the other half still shows the noise.
#[test]
fn much_motion_does_not_hide_the_noise() {
    let mut values = noise(1000 * RATE);
    for start in (0..1000).step_by(100) {
        during(&mut values, start..start + 50, |t| 3.0 * (2.0 * t).sin());
    }
    let outcome = run(&[Event::Values(&values)], false);
    assert_eq!(outcome.stretches.len(), 10);
    assert!((45_000..=50_000).contains(&outcome.values), "{}", outcome.values);
}

/// A signal that moves in coarse steps, and mostly not at all, says nothing of rest.
#[test]
fn a_coarse_signal_is_not_judged() {
    let values: Vec<_> =
        (0..50_000).map(|k| [0.0, f64::from(u8::from(k % 777 == 0)), 9.8]).collect();
    assert!(run(&[Event::Values(&values)], false).stretches.is_empty());
}

/// Half of the record is one reading on one axis: time that is left out, with the window before it.
#[test]
fn an_axis_that_freezes_is_left_out() {
    let mut values = noise(1000 * RATE);
    let last = values[49_999][1];
    values[50_000..].iter_mut().for_each(|value| value[1] = last);
    let outcome = run(&[Event::Values(&values)], false);
    let [frozen] = outcome.stretches[..] else { panic!("{:?}", outcome.stretches) };
    assert_eq!((frozen.frozen, frozen.to), ([false, true, false], 100_000));
    assert!((49_500..=50_000).contains(&frozen.from), "{frozen:?}");
    assert_eq!(outcome.values as u64, frozen.from);
    let kept = run(&[Event::Values(&values)], true);
    assert_eq!((kept.values, kept.stretches.len()), (values.len(), 1));
}

/// A driver that hangs for ten seconds, among the first windows and after them.
#[test]
fn a_sensor_that_freezes_for_a_while_becomes_missing_time() {
    for at in [100, 700] {
        let mut values = noise(1000 * RATE);
        let last = values[at * RATE];
        values[at * RATE..(at + 10) * RATE].fill(last);
        let outcome = run(&[Event::Values(&values)], false);
        let [frozen] = outcome.stretches[..] else { panic!("{:?}", outcome.stretches) };
        assert_eq!(frozen.frozen, [true; 3]);
        let near = 3 * window(RATE as f64) as u64;
        let (from, to) = ((at * RATE) as u64, ((at + 10) * RATE) as u64);
        assert!((from - near..=from).contains(&frozen.from), "{frozen:?}");
        assert!((to..=to + near).contains(&frozen.to), "{frozen:?}");
        assert_eq!(outcome.values as u64 + frozen.to - frozen.from, 100_000);
    }
}

/// Equal values in long rows that are natural: noise of a fifth of the resolution on a mean that
/// wanders over some steps of it, integers of small noise, a stuck axis, readings that are held.
#[test]
fn coarse_and_held_values_are_not_frozen() {
    let noise = noise(2000 * RATE);
    let coarse: Vec<[f64; 3]> = noise
        .iter()
        .enumerate()
        .map(|(k, value)| {
            let wander = 2.0 * (k as f64 * 5e-5).sin();
            [(0.2 * value[0] + wander).round(), (0.7 * value[1] + wander).round(), 9.8]
        })
        .collect();
    for held in [1, 2, 5, 8] {
        let values: Vec<[f64; 3]> =
            coarse.iter().step_by(held).flat_map(|value| vec![*value; held]).collect();
        let outcome = run(&[Event::Values(&values)], false);
        let frozen = outcome.stretches.iter().filter(|stretch| stretch.frozen != [false; 3]);
        assert_eq!(frozen.count(), 0, "held {held}: {:?}", outcome.stretches);
    }
    for held in [2, 8] {
        let values: Vec<[f64; 3]> =
            noise.iter().step_by(held).flat_map(|value| vec![*value; held]).collect();
        assert!(run(&[Event::Values(&values)], false).stretches.is_empty());
    }
}

/// Small steps that last, of 5 to 14 standard deviations of a window's mean, in the middle of a window
/// or over three seconds: a restart, and little else is left out.
#[test]
fn a_small_tilt_is_a_restart() {
    let size = window(RATE as f64);
    let sd = 1.0 / (size as f64).sqrt();
    for (step, over) in [(5.0, 0), (9.0, 0), (14.0, 0), (14.0, 3 * RATE), (6.0, 3 * RATE)] {
        let mut values = noise(2000 * RATE);
        let at = 700 * size + size / 2;
        for (k, value) in values.iter_mut().enumerate() {
            let part = (k.saturating_sub(at) as f64 / over.max(1) as f64).min(1.0);
            value[2] += step * sd * part;
        }
        let outcome = run(&[Event::Values(&values)], false);
        let [tilt] = outcome.stretches[..] else { panic!("{step}: {:?}", outcome.stretches) };
        let place = at as u64..=(at + over) as u64;
        let near = 2 * size as u64;
        assert!(
            tilt.from <= place.end() + near && tilt.to + near >= *place.start(),
            "{step}: {tilt:?}"
        );
        assert!(tilt.to - tilt.from <= 8 * size as u64, "{step}: {tilt:?}");
        assert_eq!((outcome.missing, outcome.restarts), (0, 1), "{step}");
        assert_eq!(outcome.values as u64 + tilt.to - tilt.from, 200_000);
    }
}

/// A sensor that warms up goes far, and is nowhere cut.
#[test]
fn a_warm_up_is_no_shift() {
    let sd = 1.0 / (window(RATE as f64) as f64).sqrt();
    for minutes in [2.0, 5.0, 10.0] {
        let mut values = noise(3000 * RATE);
        during(&mut values, 0..3000, |t| 60.0 * sd * (1.0 - (-t / (60.0 * minutes)).exp()));
        let outcome = run(&[Event::Values(&values)], false);
        assert!(outcome.stretches.is_empty(), "{minutes}: {:?}", outcome.stretches);
    }
}
