//! The two lock files must name the same versions, or the images would prove other code.

use crate::Result;
use std::path::Path;

/// Fails if a package that both lock files have is there in a version that the host's has not.
pub fn same_versions(host: &Path, firmware: &Path) -> Result<()> {
    let host_packages = packages(host)?;
    for (name, version) in packages(firmware)? {
        let mut versions = host_packages.iter().filter(|(n, _)| *n == name).map(|(_, v)| v);
        if let Some(first) = versions.clone().next()
            && !versions.any(|v| *v == version)
        {
            return Err(format!(
                "{name} is {version} in the images and {first} on the host: run `cargo update \
                 --manifest-path tests/firmware/Cargo.toml -p {name} --precise {first}`"
            ));
        }
    }
    Ok(())
}

/// Name and version of every package in a lock file.
fn packages(path: &Path) -> Result<Vec<(String, String)>> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let value = |line: &str, key: &str| {
        line.strip_prefix(key).map(|rest| rest.trim_matches('"').to_string())
    };
    let names = text.lines().filter_map(|line| value(line, "name = "));
    // The file's own `version = 4` has no quotes.
    let versions = text.lines().filter_map(|line| value(line, "version = \""));
    Ok(names.zip(versions).collect())
}
