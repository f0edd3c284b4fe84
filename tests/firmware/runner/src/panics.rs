//! When an image does not link: where the panic is that can be reached.

use std::path::Path;
use std::process::Command;

/// The function that does not exist, called by the images' panic handler.
pub const SYMBOL: &str = "a_panic_is_reachable_from_imu_core";

/// Each call of a panic function in an image, with the source lines that it was inlined through.
pub fn places(image: &Path) -> Vec<String> {
    let text = output("arm-none-eabi-objdump", &["-d", "-C"], image, None);
    let mut caller = String::new();
    let mut places = Vec::new();
    for line in text.lines() {
        // "00001234 <name>:" begins a function, "    1234:\t f7ff fffe \tbl\t5678 <name>" calls.
        if let Some(name) = line.strip_suffix(">:").and_then(|l| l.split_once('<')) {
            caller = name.1.to_string();
        } else if let Some((code, callee)) = line.split_once('<')
            && is_panic(callee)
            && !is_panic(&caller)
            && let Some((address, _)) = code.split_once(':')
        {
            let lines = output("arm-none-eabi-addr2line", &["-i", "-e"], image, Some(address));
            let lines: Vec<_> = lines.lines().map(|line| format!("    {line}")).collect();
            places.push(format!(
                "  {caller} calls {}\n{}",
                callee.trim_end_matches('>'),
                lines.join("\n")
            ));
        }
    }
    places.dedup();
    places
}

fn is_panic(name: &str) -> bool {
    name.starts_with("core::") && (name.contains("panic") || name.contains("_fail"))
        || name.contains("rust_begin_unwind")
}

fn output(program: &str, arguments: &[&str], image: &Path, last: Option<&str>) -> String {
    let mut command = Command::new(program);
    command.args(arguments).arg(image).args(last.map(str::trim));
    let output = command.output().map(|output| output.stdout).unwrap_or_default();
    String::from_utf8_lossy(&output).into_owned()
}
