//! What `imu live` takes of one core at 8 kHz and six axes, with plain lines and with the dashboard, by
//! what the system says of the process.
//!
//! `cargo run --release -p imu-tests --example live_cpu -- 60` (Linux; so many seconds of each)
//!
//! A simulated sensor sends our own frames through a pseudo-terminal in real time. Checkpoints are written as
//! often as they are where nothing is said.

use std::fs::{self, File, OpenOptions};
use std::os::fd::AsRawFd as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use imu_tests::command::imu;
use serial2::SerialPort;

fn main() {
    let seconds = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(60);
    println!("            s    user  system  CPU of one core");
    for dashboard in [false, true] {
        let folder = tempfile::tempdir().expect("a folder");
        let (user, system, wall) = measure(folder.path(), dashboard, seconds);
        let name = if dashboard { "dashboard" } else { "plain" };
        let share = 100.0 * (user + system) / wall;
        println!("{name:<9} {wall:>5.1}  {user:>4.2} s  {system:>4.2} s  {share:.2} %");
    }
}

/// Seconds that a session spent outside and inside of the kernel, and how long it ran.
fn measure(folder: &Path, dashboard: bool, seconds: u64) -> (f64, f64, f64) {
    let link = folder.join("sensor");
    let mut sensor = imu()
        .args(["simulate", "low", "--rate", "8000", "--duration", &format!("{}s", seconds + 5)])
        .args(["-o", &format!("pty:imu-frame:{}", link.display())])
        .stderr(Stdio::null())
        .spawn()
        .expect("a sensor");
    while !link.exists() {
        sleep(Duration::from_millis(10));
    }
    let mut live = imu();
    live.arg("live").arg(&link).args(["--baud", "921600", "--fresh", "--checkpoint"]);
    live.arg(folder.join("checkpoint")).env("TERM", "xterm-256color").stderr(Stdio::null());
    if dashboard {
        let (mut ours, theirs) = SerialPort::pair().expect("a terminal");
        let path = fs::read_link(format!("/proc/self/fd/{}", theirs.as_raw_fd()));
        let (input, output) = screen(&path.expect("its name"));
        live.stdin(input).stdout(output);
        ours.set_read_timeout(Duration::from_secs(1)).expect("a terminal");
        // What is drawn must be read, or the drawing waits.
        std::thread::spawn(move || {
            let (_theirs, mut drawn) = (theirs, [0; 4096]);
            loop {
                // A quiet second is none that matters.
                let _ = ours.read(&mut drawn);
            }
        });
    } else {
        live.arg("--plain").stdin(Stdio::null()).stdout(Stdio::null());
    }
    let start = Instant::now();
    let mut live = live.spawn().expect("imu can be started");
    sleep(Duration::from_secs(seconds));
    let wall = start.elapsed().as_secs_f64();
    let [user, system] = spent(live.id());
    live.kill().expect("a session");
    live.wait().expect("a session");
    sensor.kill().expect("a sensor");
    sensor.wait().expect("a sensor");
    (user, system, wall)
}

/// Both directions of a terminal of 120 by 40.
fn screen(path: &Path) -> (File, File) {
    let open = || OpenOptions::new().read(true).write(true).open(path).expect("a terminal");
    let stty = Command::new("stty").args(["cols", "120", "rows", "40"]).stdin(open()).status();
    assert!(stty.expect("stty").success());
    (open(), open())
}

/// User and system time of a process, s: fields 14 and 15 of what proc(5) tells, in hundredths.
fn spent(id: u32) -> [f64; 2] {
    let text = fs::read_to_string(format!("/proc/{id}/stat")).expect("a running session");
    let (_, fields) = text.rsplit_once(')').expect("a name in brackets");
    let fields: Vec<&str> = fields.split_whitespace().collect();
    [11, 12].map(|at| fields[at].parse::<f64>().expect("a number") * 0.01)
}
