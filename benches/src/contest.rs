//! Contenders measured side by side: on a shared machine a mean measures the neighbours as well, so their passes are
//! interleaved, and the fastest pass of each counts, with the median beside it.

use std::process::ExitCode;
use std::time::Instant;

/// At most so many ns an item, if that was promised, and so many times the baseline.
pub struct Budget {
    /// ns an item.
    pub time: Option<f64>,
    /// Times the baseline.
    pub ratio: f64,
}

/// What is measured, with its passes in ns an item.
pub struct Contender<'a> {
    name: &'static str,
    budget: Option<Budget>,
    pass: Box<dyn FnMut() + 'a>,
    times: Vec<f64>,
}

impl<'a> Contender<'a> {
    /// One without a budget: the baseline of those that follow it.
    pub fn baseline(name: &'static str, pass: impl FnMut() + 'a) -> Self {
        Self { name, budget: None, pass: Box::new(pass), times: Vec::new() }
    }

    /// One that has to keep a budget.
    pub fn new(name: &'static str, budget: Budget, pass: impl FnMut() + 'a) -> Self {
        Self { name, budget: Some(budget), pass: Box::new(pass), times: Vec::new() }
    }
}

/// Runs `rounds` passes of each, of so many items, prints a table, and fails if a budget is exceeded.
pub fn decide(mut contenders: Vec<Contender>, rounds: usize, items: usize) -> ExitCode {
    for _ in 0..rounds {
        for contender in &mut contenders {
            let start = Instant::now();
            (contender.pass)();
            contender.times.push(start.elapsed().as_secs_f64() * 1e9 / items as f64);
        }
    }
    println!("{:26} {:>8} {:>8} {:>6} {:>8}  median", "", "fastest", "at most", "ratio", "at most");
    let (mut met, mut baseline) = (true, f64::NAN);
    for Contender { name, budget, times, .. } in &mut contenders {
        times.sort_by(f64::total_cmp);
        let (fastest, median) = (times[0], times[rounds / 2]);
        let Some(Budget { time, ratio }) = budget else {
            baseline = fastest;
            println!("{name:26} {fastest:8.2} {:>8} {:>6} {:>8} {median:7.2}", "", "", "");
            continue;
        };
        let promised = time.map_or_else(String::new, |time| format!("{time:.2}"));
        let times_slower = fastest / baseline;
        println!(
            "{name:26} {fastest:8.2} {promised:>8} {times_slower:6.2} {ratio:8.2} {median:7.2}"
        );
        met &= times_slower <= *ratio && time.is_none_or(|time| fastest <= time);
    }
    if met { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
