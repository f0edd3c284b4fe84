//! A program that is interrupted leaves the folder as it found it.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use imu_tests::command::imu;
use imu_tests::recordings::Folder;

#[test]
fn ctrl_c_and_sigterm_leave_nothing_half_written() {
    for (signal, code, name) in
        [("INT", 130, "long.bag"), ("TERM", 143, "long.csv"), ("TERM", 143, "long/")]
    {
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
