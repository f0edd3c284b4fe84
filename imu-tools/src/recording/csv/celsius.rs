//! Scales of temperature, by the names that columns give them.

/// A scale of temperature: degrees Celsius are `factor` times what stands there, plus `zero`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Celsius {
    /// Of one degree.
    pub factor: f64,
    /// Where the scale's zero is.
    pub zero: f64,
}

impl Default for Celsius {
    fn default() -> Self {
        Self { factor: 1.0, zero: 0.0 }
    }
}

impl Celsius {
    /// The scale of that name; `None` for one that nobody knows.
    pub fn of(unit: Option<&str>) -> Option<Self> {
        let letters = unit.unwrap_or_default().to_lowercase();
        let letters: String = letters.chars().filter(|c| c.is_alphabetic()).collect();
        match letters.trim_start_matches("deg") {
            "" | "c" | "celsius" | "cel" => Some(Self::default()),
            "k" | "kelvin" => Some(Self { factor: 1.0, zero: -273.15 }),
            "f" | "fahrenheit" => Some(Self { factor: 5.0 / 9.0, zero: -160.0 / 9.0 }),
            _ => None,
        }
    }
}
