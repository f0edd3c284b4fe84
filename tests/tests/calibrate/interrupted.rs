//! A program that is interrupted leaves the folder as it found it.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use imu_tests::command::imu;
use imu_tests::recordings::Folder;

/// Whether this test, and what it starts, goes on when its terminal is closed: under `nohup`, and
/// where the system does not tell.
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_none_or(|mask| !mask.trim().ends_with(['0', '2', '4', '6', '8', 'a', 'c', 'e']))
}

#[test]
fn interruptions_leave_nothing_half_written() {
    let cases = [
        ("INT", 130, "long.bag"),
        ("TERM", 143, "long.csv"),
        ("TERM", 143, "long/"),
        ("HUP", 129, "long.mcap"),
    ];
    for (signal, code, name) in cases {
        if signal == "HUP" && hangups_are_ignored() {
            continue;
        }
        let folder = Folder::new();
        // Eight years of samples: it does not end by itself.
        let out = folder.at(name);
        let mut program = imu()
            .args(["simulate", "--duration", "3000d", "--rate", "10", "-o", &out])
            .args(["--truth", &folder.at("truth.csv")])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("started");
        let patience = Instant::now() + Duration::from_secs(60);
        while folder.names().len() < 2 {
            assert!(Instant::now() < patience, "nothing is being written");
            std::thread::sleep(Duration::from_millis(2));
        }
        let sent = Command::new("kill").args(["-s", signal, &program.id().to_string()]).status();
        assert!(sent.expect("kill can be started").success());
        assert_eq!(program.wait().expect("ended").code(), Some(code), "{signal}");
        assert_eq!(folder.names(), [""; 0]);
    }
}
