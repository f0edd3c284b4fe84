//! `imu convert` as a user calls it: every sample as it was, what is lost said, and no recording
//! harmed.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use imu_tests::bags::{bag, chunk, connection, message};
use imu_tests::command::{Said, imu, run, said};
use imu_tests::recordings::{Folder, calibrate, simulated};
use imu_tools::recording::{self, Block, Format, ReadOptions, Sample, Temperature};

const SHORT: &str = "rate_hz = 100\nduration = \"100s\"\n[gyroscope]\nnoise_density = 0.01\n\
                     [accelerometer]\nnoise_density = 0.02\n";

fn convert(arguments: &[&str]) -> Said {
    run(&[&["convert"], arguments].concat())
}

/// Converts, which must work, and gives what was said of it.
fn converted(arguments: &[&str]) -> Said {
    let said = convert(arguments);
    assert_eq!(said.code, 0, "{arguments:?}: {}", said.err);
    said
}

/// All samples of a recording.
fn samples(path: &str) -> Block {
    let mut source = recording::open(Path::new(path), &ReadOptions::default()).expect("opened");
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block).expect("read") {
        all.gyroscope.extend_from_slice(&block.gyroscope);
        all.accelerometer.extend_from_slice(&block.accelerometer);
    }
    all
}

/// Stamps and bits of all values, a list a sensor: NaN is equal to itself, 0 is not -0.
fn bits(block: &Block) -> [Vec<(i64, [u64; 3])>; 2] {
    let list = |samples: &[Sample]| {
        samples.iter().map(|s| (s.stamp_ns, s.value.map(f64::to_bits))).collect()
    };
    [list(&block.gyroscope), list(&block.accelerometer)]
}

/// Stamps that do not follow a grid, doubles of every size, sensors of different rates, stretches
/// where one of them is silent, and stamps that both share now and then.
fn wild() -> Block {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let mut block = Block::default();
    let mut stamp_ns = 1_600_000_000_123_456_789;
    for i in 0..30_000 {
        stamp_ns += 1 + (random() % 5_000_000) as i64;
        let mut value = || {
            // Any finite double, the smallest included.
            let x = f64::from_bits(random());
            if x.is_finite() { x } else { -0.0 }
        };
        let (rate, force) = ([value(), value(), value()], [value(), value(), value()]);
        let silent = (10_000..22_000).contains(&i);
        if i % 3 != 1 {
            block.gyroscope.push(Sample { stamp_ns, value: rate });
        }
        if i % 4 != 2 && !silent {
            block.accelerometer.push(Sample { stamp_ns, value: force });
        }
    }
    block
}

/// The formats that are one file; a row of EuRoC's has both sensors, always.
fn files() -> impl Iterator<Item = Format> {
    Format::ALL.into_iter().filter(|format| *format != Format::Euroc)
}

#[test]
fn every_file_gives_back_every_bit() {
    give_back(&wild(), &files().collect::<Vec<_>>());
}

#[test]
fn every_format_gives_back_every_bit_of_sensors_in_step() {
    let mut block = wild();
    block.accelerometer = block.gyroscope.clone();
    for Sample { value, .. } in &mut block.accelerometer {
        value.reverse();
    }
    give_back(&block, &Format::ALL);
}

/// Converts between all of these formats.
fn give_back(block: &Block, formats: &[Format]) {
    let folder = Folder::new();
    let source = folder.record("source.bag", block);
    for one in formats {
        for other in formats {
            let middle = folder.at(&format!("{}_{}.{}", one.name(), other.name(), one.name()));
            let end = folder.at(&format!("end_{}_{}.{}", one.name(), other.name(), other.name()));
            converted(&[&source, &middle]);
            converted(&[&middle, &end]);
            assert_eq!(bits(&samples(&middle)), bits(block), "{middle}");
            assert_eq!(bits(&samples(&end)), bits(block), "{end}");
        }
    }
}

#[test]
fn samples_of_one_instant_stay_in_one_row() {
    let folder = Folder::new();
    let source = folder.record("a.bag", &wild());
    let (csv, back) = (folder.at("a.csv"), folder.at("b.bag"));
    converted(&[&source, &csv]);
    converted(&[&csv, &back]);
    // The bag that has the same messages in the same order is the same file.
    assert!(fs::read(&source).expect("read") == fs::read(&back).expect("read"));
}

#[test]
fn a_gyroscope_that_was_written_long_before_its_accelerometer_meets_it() {
    let folder = Folder::new();
    let stamps = |range: std::ops::Range<usize>, what: &str| {
        range
            .map(|i| format!("{},{}\n", i * 5_000_000, what.replace('#', &i.to_string())))
            .collect()
    };
    let mut rows = vec!["t [ns],gx,gy,gz,ax,ay,az\n".to_owned()];
    for second in 0..40 {
        rows.push(stamps(second * 200..(second + 1) * 200, "#,0,0,,,"));
        rows.push(stamps(second * 200..(second + 1) * 200, ",,,0,#,9.8"));
    }
    let skewed = folder.put("skewed.csv", rows.concat());
    let whole = folder.at("whole.csv");
    let said = converted(&[&skewed, &whole]);
    assert_eq!(said.out, format!("wrote 8000 samples of both sensors (39.995 s) to {whole}\n"));
    let text = fs::read_to_string(&whole).expect("written");
    assert_eq!(text.lines().count(), 8001);
    assert!(text.lines().all(|row| !row.contains(",,")), "a row lacks a sensor");
    assert_eq!(bits(&samples(&whole)), bits(&samples(&skewed)));
}

#[test]
fn a_pipe_at_both_ends() {
    let folder = Folder::new();
    let block = simulated(SHORT, 1);
    let (bag, csv) = (folder.record("a.bag", &block), folder.record("a.csv", &block));
    for from in [&bag, &csv] {
        for format in files() {
            let mut program = imu()
                .args(["convert", "-", "-", "--to", format.name()])
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .expect("started");
            let mut stdin = program.stdin.take().expect("a pipe");
            let bytes = fs::read(from).expect("read");
            let feeder = std::thread::spawn(move || stdin.write_all(&bytes));
            let output = program.wait_with_output().expect("ended");
            feeder.join().expect("fed").expect("all was taken");
            assert!(output.status.success(), "{}", said(&output).err);
            let name = format!("piped.{}", format.name());
            let piped = folder.put(&name, &output.stdout);
            assert_eq!(bits(&samples(&piped)), bits(&block), "{from} to {}", format.name());
            // A pipe cannot go back to the header: that is told, and is no loss.
            let told = run(&["info", &piped]);
            assert_eq!(told.code, 0, "{}", told.err);
            assert!(!told.err.contains("not closed") && !told.out.contains("not closed"));
            let through_a_pipe =
                told.out.contains("through a pipe") || told.err.contains("through a pipe");
            assert_eq!(through_a_pipe, format.name() == "bag", "{}{}", told.out, told.err);
        }
    }
}

#[test]
fn what_the_new_file_cannot_hold_is_said() {
    let folder = Folder::new();
    let records = [
        connection(0, "/imu", "sensor_msgs/Imu"),
        connection(1, "/odom", "nav_msgs/Odometry"),
        message(0, 5, 0),
        message(1, 5, 0),
        message(1, 6, 0),
        message(0, 6, 0),
    ];
    let source = folder.put("drive.bag", bag(&[chunk(&records)]));
    let said = converted(&[&source, &folder.at("drive.csv")]);
    for words in [
        "imu: orientation, covariances and frame of the messages",
        "imu: 2 messages of other topics are not written: /odom\n",
    ] {
        assert!(said.err.contains(words), "'{words}' is not in {}", said.err);
    }
    let said = converted(&["--json", &source, &folder.at("again.csv")]);
    assert_eq!(said.err, "");
    let json: serde_json::Value = serde_json::from_str(&said.out).expect("one JSON object");
    assert_eq!(json["gyroscope"]["samples"], 2);
    assert_eq!(json["first_stamp_ns"], 5_000_000_000_i64);
    assert_eq!(json["left_out"].as_array().map(Vec::len), Some(2));
    // A table of numbers loses nothing, and nothing is said.
    let said = converted(&[&folder.at("again.csv"), &folder.at("again.bag")]);
    assert_eq!(said.err, "");

    let table = "i,t,gx,gy,gz,mag_x,mag_y\n0,0.1,1,2,3,4,5\n1,0.2,1,2,3,4,5\n";
    let said = converted(&[&folder.put("mag.csv", table), &folder.at("mag.bag")]);
    let words = "imu: other columns of the table are not written: i, mag_x, mag_y\n";
    assert!(said.err.contains(words), "{}", said.err);

    // A bag's clock begins in 1970.
    let early = Block {
        gyroscope: vec![Sample { stamp_ns: -1, value: [0.0; 3] }],
        temperature: vec![Temperature { stamp_ns: 0, celsius: 20.0 }],
        ..Block::default()
    };
    let early = folder.record("early.csv", &early);
    let said = convert(&[&early, &folder.at("early.bag")]);
    assert_eq!(said.code, 1);
    assert!(said.err.contains("cannot hold the stamp -1 ns"), "{}", said.err);
    assert!(!folder.names().contains(&"early.bag".to_owned()));
}

#[test]
fn a_bag_that_was_cut_off_is_whole_again() {
    let folder = Folder::new();
    let block = simulated(SHORT, 1);
    let bytes = fs::read(folder.record("a.bag", &block)).expect("read");
    let broken = folder.put("broken.bag", &bytes[..bytes.len() / 2]);
    let whole = folder.at("whole.bag");
    let said = converted(&[&broken, &whole]);
    assert!(said.err.contains("imu: warning: ") && said.err.contains("broken.bag"), "{}", said.err);
    let saved = samples(&whole);
    let count = saved.gyroscope.len();
    assert!(count > 3000, "{count} of 10000");
    let [rates, forces] = bits(&block);
    assert_eq!(bits(&saved), [rates[..count].to_vec(), forces[..count].to_vec()]);
    let said = calibrate(&[&whole]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(!said.err.contains("cut off"), "{}", said.err);
}

#[test]
fn nothing_readable_is_an_error_and_no_file() {
    let folder = Folder::new();
    let header = folder.put("header.csv", "t,gx,gy,gz,ax,ay,az\n");
    let no_messages = bag(&[chunk(&[connection(0, "/imu", "sensor_msgs/Imu")])]);
    let no_messages = folder.put("none.bag", no_messages);
    for path in [&header, &no_messages] {
        let said = convert(&[path, &folder.at("out.csv")]);
        assert_eq!(said.code, 1, "{}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
        assert!(said.err.contains(path.as_str()), "{}", said.err);
    }
    assert_eq!(folder.names(), ["header.csv", "none.bag"]);
}

#[test]
fn a_recording_is_never_written_over_by_itself() {
    let folder = Folder::new();
    let block = simulated(SHORT, 1);
    let source = folder.record("a.bag", &block);
    let mut others = vec![
        source.clone(),
        folder.path().join(".").join("a.bag").to_str().expect("UTF-8").to_owned(),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("a.bag", folder.path().join("soft.bag")).expect("linked");
        fs::hard_link(&source, folder.path().join("hard.bag")).expect("linked");
        others.extend([folder.at("soft.bag"), folder.at("hard.bag")]);
    }
    // A folder and the file in it.
    let sequence = folder.at("sequence/");
    converted(&[&source, &sequence]);
    let data = folder.at("sequence/mav0/imu0/data.csv");
    for (from, to) in [(&sequence, &sequence), (&data, &sequence), (&sequence, &data)] {
        let said = convert(&[from, to]);
        assert_eq!(said.code, 2, "{from} {to}: {}", said.err);
        assert!(said.err.contains("is the recording itself"), "{}", said.err);
    }
    for other in &others {
        let said = convert(&[&source, other]);
        assert_eq!(said.code, 2, "{other}: {}", said.err);
        assert!(said.err.contains("is the recording itself"), "{}", said.err);
    }
    assert_eq!(bits(&samples(&source)), bits(&block));

    // The new name forgotten behind `*.bag`.
    let (b, c) = (folder.record("b.bag", &block), folder.record("c.bag", &block));
    let said = convert(&[&source, &b, &c]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("c.bag is there already"), "{}", said.err);
    // So must not a slip of the finger behind one.
    fs::write(&c, "precious").expect("written");
    let said = convert(&[&source, &c]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("c.bag is there already") && said.err.contains("--force"));
    assert_eq!(fs::read(&c).expect("read"), b"precious");
    converted(&[&source, &c, "--force"]);
    assert_eq!(bits(&samples(&c)), bits(&block));
    let said = convert(&[&source, &sequence]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("data.csv is there already"), "{}", said.err);
}

#[test]
fn folders_are_made_where_the_program_is_called() {
    let folder = Folder::new();
    folder.record("a.bag", &simulated(SHORT, 1));
    for arguments in [
        &["convert", "a.bag", "one/"][..],
        &["convert", "a.bag", "mav0"],
        &["convert", "a.bag", "two", "--to", "euroc"],
        &["simulate", "--duration", "2s", "-o", "three/"],
        &["simulate", "--duration", "2s", "-o", "./four/five/"],
    ] {
        let output = imu().args(arguments).current_dir(folder.path()).output().expect("started");
        assert!(output.status.success(), "{arguments:?}: {}", said(&output).err);
    }
    for made in ["one/mav0", "mav0", "two/mav0", "three/mav0", "four/five/mav0"] {
        assert!(folder.path().join(made).join("imu0/data.csv").is_file(), "{made}");
    }
}

#[test]
fn mistakes_on_the_command_line() {
    let folder = Folder::new();
    let source = folder.record("a.bag", &simulated(SHORT, 1));
    for (arguments, words) in [
        (vec!["convert", &source], "after it the file to write"),
        (vec!["convert", &source, "b.xyz"], "cannot tell the format of b.xyz"),
        (vec!["convert", &source, "b.bag", "--to", "word"], "the formats that can be written are"),
        (vec!["convert", &source, "-", "--to", "euroc"], "a pipe cannot be one"),
        (vec!["convert", &source, "-", "--json"], "cannot both go to the standard output"),
        (vec!["convert", &source, "b.csv", "--columns", "t,gx"], "--columns"),
        (vec!["convert", &source, "b.csv", "--gyro-unit", "furlong"], "no unit of angular rate"),
    ] {
        let said = run(&arguments);
        assert_eq!(said.code, 2, "{arguments:?}: {}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
        assert!(said.err.contains(words), "{}", said.err);
    }
    assert_eq!(folder.names(), ["a.bag"]);
}
