//! EuRoC's folders in and out, TUM-VI's, and files of poses.

use std::fs;
use std::path::Path;

use imu_tests::recordings::{Folder, simulated};
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample};

const SCENE: &str = "\
rate_hz = 200
duration = \"60s\"
[gyroscope]
noise_density = 0.01
[accelerometer]
noise_density = 0.02
";

fn read(path: &Path) -> (Block, Vec<Note>) {
    let mut source = recording::open(path, &ReadOptions::default()).unwrap();
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block).unwrap() {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
    }
    (all, source.take_notes())
}

fn refusal(path: &Path) -> String {
    recording::open(path, &ReadOptions::default()).err().unwrap().to_string()
}

#[test]
fn what_is_written_is_read_back_from_every_level() {
    let folder = Folder::new();
    let block = simulated(SCENE, 3);
    for path in [folder.at("out/"), folder.at("other/mav0")] {
        let mut sink = recording::create(path.as_ref()).unwrap();
        // In blocks that cut the two sensors differently.
        let (a, b) = (block.gyroscope.split_at(700), block.accelerometer.split_at(500));
        for (g, a) in [(a.0, b.0), (a.1, b.1)] {
            let (gyroscope, accelerometer) = (g.to_vec(), a.to_vec());
            sink.write_block(&Block { gyroscope, accelerometer, ..Block::default() }).unwrap();
        }
        sink.finish().unwrap();
    }
    for level in ["out", "out/mav0", "out/mav0/imu0", "other", "out/mav0/imu0/data.csv"] {
        let (read, notes) = read(&folder.path().join(level));
        assert_eq!(read, block, "{level}");
        if level.ends_with("csv") {
            assert_eq!(notes, []);
        } else {
            let [Note::Info(said)] = &notes[..] else { panic!("{notes:?}") };
            assert!(said.contains("sensor.yaml says 200.0 Hz"), "{said}");
        }
    }
    let text = fs::read_to_string(folder.at("out/mav0/imu0/data.csv")).unwrap();
    assert!(text.starts_with("#timestamp [ns],w_RS_S_x [rad s^-1],"));
}

#[test]
fn folders_appear_whole_or_not_at_all() {
    let folder = Folder::new();
    let block = simulated(SCENE, 3);
    let mut sink = recording::create(folder.at("out/").as_ref()).unwrap();
    sink.write_block(&block).unwrap();
    drop(sink);
    assert!(folder.names().is_empty());
    // A sensor alone has no place in EuRoC's rows.
    let mut sink = recording::create(folder.at("out/").as_ref()).unwrap();
    let mut lone = block.clone();
    lone.accelerometer.remove(3);
    let error = sink.write_block(&lone).unwrap_err();
    assert!(error.to_string().contains("both sensors in every row"), "{error}");
    drop(sink);
    let mut sink = recording::create(folder.at("out/").as_ref()).unwrap();
    lone = block;
    lone.accelerometer.pop();
    sink.write_block(&lone).unwrap();
    assert!(sink.finish().is_err());
    assert!(folder.names().is_empty());
}

/// The usual step between jittering stamps is not the mean one.
#[test]
fn the_rate_is_that_of_the_whole_recording() {
    let folder = Folder::new();
    let mut block = simulated(SCENE, 3);
    for list in [&mut block.gyroscope, &mut block.accelerometer] {
        // Stamps come late by up to 1 ms, and 0.1 s is missing.
        for (k, sample) in (0_i64..).zip(list.iter_mut()) {
            sample.stamp_ns += 1000 * (k * k * 7919 % 1009);
        }
        list.drain(500..520);
    }
    let mut sink = recording::create(folder.at("out/").as_ref()).unwrap();
    sink.write_block(&block).unwrap();
    sink.finish().unwrap();
    let yaml = fs::read_to_string(folder.at("out/mav0/imu0/sensor.yaml")).unwrap();
    let rate = yaml.lines().find_map(|line| line.strip_prefix("rate_hz: ")).unwrap();
    // 1 ms of 60 s.
    assert!((rate.parse::<f64>().unwrap() - 200.0).abs() < 200.0 * 1.7e-5, "{rate}");
}

#[test]
fn several_imus_are_listed() {
    let folder = Folder::new();
    for imu in ["mav0/imu0", "mav0/imu1"] {
        fs::create_dir_all(folder.at(imu)).unwrap();
        fs::write(folder.at(&format!("{imu}/data.csv")), "0,1,2,3,4,5,6\n5000000,1,2,3,4,5,6\n")
            .unwrap();
    }
    let error = recording::open(folder.path(), &ReadOptions::default()).err().unwrap();
    assert_eq!(error.exit_code(), 2);
    assert!(
        error.to_string().contains("imu0/data.csv, ")
            && error.to_string().contains("imu1/data.csv")
    );
    let survey = ReadOptions { survey: true, ..ReadOptions::default() };
    let mut source = recording::open(folder.path(), &survey).unwrap();
    assert!(
        source
            .take_notes()
            .iter()
            .any(|n| matches!(n, Note::Warning(w) if w.contains("the first")))
    );
    assert_eq!(read(&folder.path().join("mav0/imu1")).0.gyroscope.len(), 2);
}

#[test]
fn tum_vi() {
    let folder = Folder::new();
    fs::create_dir_all(folder.at("dso")).unwrap();
    let text = "# timestamp[ns] w.x w.y w.z a.x a.y a.z\n\
                1520530308199447626 0.1 0.2 0.3 9.1 -0.2 0.4\n\
                1520530308204447626 0.1 0.2 0.3 9.1 -0.2 0.4\n";
    fs::write(folder.at("dso/imu.txt"), text).unwrap();
    let (block, _) = read(folder.path());
    let stamp_ns = 1_520_530_308_199_447_626;
    assert_eq!(block.gyroscope[0], Sample { stamp_ns, value: [0.1, 0.2, 0.3] });
    assert_eq!(block.accelerometer[0], Sample { stamp_ns, value: [9.1, -0.2, 0.4] });
}

#[test]
fn folders_and_files_without_an_imu_say_so() {
    let folder = Folder::new();
    assert!(refusal(folder.path()).contains("a folder without a recording"));
    let row = "1403636580.838555648 4.6 -1.7 0.7 -0.1 0.7 0.1 0.7\n";
    let tum = folder.put("poses.txt", row.repeat(3));
    assert!(refusal(tum.as_ref()).contains("holds 3 poses and no IMU samples"));
    let truth = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], \
                 q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], \
                 b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], \
                 b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n\
                 1403636580838555648,4,-1,0,0.5,-0.1,-0.8,-0.1,0,0,0,0,0,0,0,0,0\n";
    fs::create_dir_all(folder.at("state_groundtruth_estimate0")).unwrap();
    fs::write(folder.at("state_groundtruth_estimate0/data.csv"), truth).unwrap();
    let said = refusal(&folder.path().join("state_groundtruth_estimate0"));
    assert!(said.contains("holds 1 poses and no IMU samples"), "{said}");
}
