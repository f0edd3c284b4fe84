//! The formats that can be written, and how their names tell them apart.

use std::path::Path;
use std::str::FromStr;

use super::euroc::is_folder_name;
use crate::error::Error;

/// A format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A ROS 1 bag.
    Bag,
    /// An MCAP file of ROS 2.
    Mcap,
    /// A table in text.
    Csv,
    /// EuRoC's folders.
    Euroc,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Bag, Self::Mcap, Self::Csv, Self::Euroc];

    /// Those that are one file.
    const FILES: [Self; 3] = [Self::Bag, Self::Mcap, Self::Csv];

    /// The word for it, which is also the ending of its files where it is one file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bag => "bag",
            Self::Mcap => "mcap",
            Self::Csv => "csv",
            Self::Euroc => "euroc",
        }
    }

    /// The format that a file of this name would have; `-`, a pipe, is a CSV, and a path that ends
    /// in `/` or `mav0` is EuRoC's.
    ///
    /// # Errors
    /// When the name has another ending.
    pub fn of(path: &Path) -> Result<Self, Error> {
        if path == Path::new("-") {
            return Ok(Self::Csv);
        }
        if is_folder_name(path) {
            return Ok(Self::Euroc);
        }
        let ending = path.extension().and_then(|ending| ending.to_str());
        let found = ending.and_then(|ending| ending.to_lowercase().parse().ok());
        found.ok_or_else(|| {
            Error::usage(format!(
                "cannot tell the format of {} from its name: end it with {}, or with / for \
                 EuRoC's folders",
                path.display(),
                list(".", &Self::FILES)
            ))
        })
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|format| format.name() == name);
        found.ok_or_else(|| format!("the formats that can be written are {}", list("", &Self::ALL)))
    }
}

/// The names of `formats`, each after `before`: `.bag or .csv`.
fn list(before: &str, formats: &[Format]) -> String {
    let mut text = String::new();
    for (at, format) in formats.iter().enumerate() {
        text += match at {
            0 => "",
            at if at + 1 == formats.len() => " or ",
            _ => ", ",
        };
        text += before;
        text += format.name();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_formats_and_back() {
        for format in Format::ALL {
            assert_eq!(format.name().parse(), Ok(format));
        }
        for path in ["out/", "out/mav0", "mav0"] {
            assert_eq!(Format::of(Path::new(path)).unwrap(), Format::Euroc);
        }
        for format in Format::FILES {
            assert_eq!(Format::of(Path::new(&format!("a.b.{}", format.name()))).unwrap(), format);
        }
        assert_eq!(Format::of(Path::new("A.BAG")).unwrap(), Format::Bag);
        let error = Format::of(Path::new("a.xyz")).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(&list(".", &Format::FILES)), "{error}");
    }
}
