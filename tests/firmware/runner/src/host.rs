//! The same cases on the host: the words that the images must print.

use firmware_cases::{CASES, Report};

/// Each case's name and words.
type Words = Vec<(String, Vec<u64>)>;

struct Host(Vec<u64>);

impl Report for Host {
    fn word(&mut self, bits: u64) {
        self.0.push(bits);
    }
    fn instructions(&mut self, _: &'static str, _: u32, work: &mut dyn FnMut()) {
        work();
    }
    fn stack(&mut self, _: &'static str, work: &mut dyn FnMut()) {
        work();
    }
    fn state(&mut self, _: &'static str, _: usize) {}
}

/// Runs every case.
pub fn run() -> Words {
    let words = |case: &firmware_cases::Case| {
        let mut host = Host(Vec::new());
        (case.run)(&mut host);
        (case.name.to_string(), host.0)
    };
    CASES.iter().map(words).collect()
}

/// Prints, case by case, whether the target's words are the host's; true if all are.
pub fn compare(target: &str, host: &Words, image: &Words) -> bool {
    let mut good = true;
    for (index, (name, expected)) in host.iter().enumerate() {
        let got = image.get(index).filter(|(n, _)| n == name).map_or(&[][..], |(_, w)| w);
        let differing = expected.iter().zip(got).position(|(a, b)| a != b);
        let complaint = if let Some(at) = differing {
            let (a, b) = (expected[at], got[at]);
            format!(
                "word {at} is {b:016x} ({:e}), on the host {a:016x} ({:e})",
                f64::from_bits(b),
                f64::from_bits(a)
            )
        } else if got.len() != expected.len() {
            format!("{} words, on the host {}", got.len(), expected.len())
        } else {
            println!("{target:4} {name}: {} words as on the host", got.len());
            continue;
        };
        println!("{target:4} {name}: DIFFERS: {complaint}");
        good = false;
    }
    good
}
