//! EuRoC's folders, `mav0/imu0/data.csv` with a `sensor.yaml` beside it, and TUM-VI's `dso/imu.txt`.
//!
//! Read from the folder at any of its levels. Written for a path that ends in `/`, which gets a
//! `mav0` in it, or in `mav0` itself. Layout and header: Burri et al. (2016), "The EuRoC micro aerial
//! vehicle datasets"; Schubert et al. (2018), "The TUM VI benchmark".

mod sensor;
mod writer;

use std::path::{Path, PathBuf};

pub use writer::EurocWriter;
pub(crate) use writer::data_file;

use super::noted::Noted;
use super::{Note, ReadOptions, Source, open_file};
use crate::error::Error;

/// The table of an IMU's folder, also compressed.
const TABLES: [&str; 3] = ["data.csv", "data.csv.gz", "data.csv.zst"];

/// Opens the IMU in a folder; `None` when there is none.
///
/// # Errors
/// When there are several, or its table cannot be read.
pub(super) fn open(folder: &Path, options: &ReadOptions) -> Result<Option<Box<dyn Source>>, Error> {
    let mut found = tables(folder)?;
    let mut notes = Vec::new();
    if found.len() > 1 {
        let names: Vec<String> = found.iter().map(|path| path.display().to_string()).collect();
        let several = format!("{} holds several IMUs: {}", folder.display(), names.join(", "));
        if !options.survey {
            return Err(Error::usage(format!("{several}; name one of these files")));
        }
        found.truncate(1);
        notes.push(Note::Warning(format!("{several}; the first is read")));
    }
    let Some(table) = found.pop() else { return Ok(None) };
    let source = open_file(&table, options)?;
    notes.extend(sensor::note(&table.with_file_name("sensor.yaml")));
    Ok(Some(Box::new(Noted::new(source, notes))))
}

/// The tables of all IMUs in a folder, sorted.
fn tables(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    if let Some(own) = table(folder) {
        return Ok(vec![own]);
    }
    for parent in [folder.join("mav0"), folder.to_owned()] {
        let mut found: Vec<PathBuf> =
            imus(&parent)?.iter().filter_map(|folder| table(folder)).collect();
        if !found.is_empty() {
            found.sort();
            return Ok(found);
        }
    }
    let tum = [folder.join("dso/imu.txt"), folder.join("imu.txt")];
    Ok(tum.into_iter().find(|path| path.is_file()).into_iter().collect())
}

fn table(folder: &Path) -> Option<PathBuf> {
    TABLES.iter().map(|name| folder.join(name)).find(|path| path.is_file())
}

/// The folders imu0, imu1, … in a folder.
fn imus(parent: &Path) -> Result<Vec<PathBuf>, Error> {
    if !parent.is_dir() {
        return Ok(Vec::new());
    }
    let refused = |e| Error::io("read", parent, e);
    let mut imus = Vec::new();
    for entry in std::fs::read_dir(parent).map_err(refused)? {
        let entry = entry.map_err(refused)?;
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix("imu"));
        if number.is_some_and(|number| number.parse::<u32>().is_ok()) {
            imus.push(entry.path());
        }
    }
    Ok(imus)
}

/// Whether a recording to be written at `path` is to be a folder: it ends in `/` or in `mav0`.
pub(super) fn is_folder_name(path: &Path) -> bool {
    let text = path.as_os_str().as_encoded_bytes();
    let slash = text.last().is_some_and(|&byte| std::path::is_separator(char::from(byte)));
    slash || path.file_name().is_some_and(|name| name == "mav0")
}
