//! `imu integrate` against poses in a topic of the recording itself: the same errors as against the same poses in a
//! file, whatever the type of the messages and the format of the recording.

use std::fmt::Write as _;
use std::path::Path;

use imu_tests::command::{Said, run};
use imu_tests::recordings::Folder;
use imu_tests::{bags, databases, mcaps};
use imu_tools::recording::poses::{Pose, Poses};
use imu_tools::recording::{self, Block, ReadOptions};
use serde_json::Value;

/// Types of messages: name in ROS 1, texts behind the header, doubles behind the pose.
const TYPES: [(&str, usize, usize); 4] = [
    ("geometry_msgs/PoseStamped", 0, 0),
    ("geometry_msgs/PoseWithCovarianceStamped", 0, 36),
    ("geometry_msgs/TransformStamped", 1, 0),
    ("nav_msgs/Odometry", 1, 36 + 6 + 36),
];

/// Names of frames whose lengths leave every remainder of 4, so that each needs another padding.
const FRAMES: [&str; 4] = ["map", "odom", "world", "mocap0"];

/// A message of any recording: its topic by number, its second, its bytes in the wire form of ROS 1 or 2.
type Message = (u32, u32, Vec<u8>);

/// The classic ellipse, 3 s at 200 Hz without any error, and its pose at every fourth sample.
struct Drive {
    folder: Folder,
    imu: Block,
    poses: Vec<Pose>,
}

impl Drive {
    fn new() -> Self {
        let folder = Folder::new();
        let scene = folder
            .put("scene.toml", "rate_hz = 200\nduration = \"3.005s\"\nmotion = \"ellipse\"\n");
        let (csv, truth) = (folder.at("imu.csv"), folder.at("true.csv"));
        let said = run(&["simulate", &scene, "-o", &csv, "--truth", &truth]);
        assert_eq!(said.code, 0, "{}", said.err);
        let mut source = recording::open(Path::new(&csv), &ReadOptions::default()).expect("a CSV");
        let (mut imu, mut block) = (Block::default(), Block::default());
        while source.next_block(&mut block).expect("read") {
            imu.gyroscope.append(&mut block.gyroscope);
            imu.accelerometer.append(&mut block.accelerometer);
        }
        let (mut all, mut poses) = (Poses::open(Path::new(&truth)).expect("poses"), Vec::new());
        let mut tum = String::new();
        while let Some(pose) = all.next_pose().expect("a pose") {
            if (pose.stamp_ns / 5_000_000) % 4 == 0 {
                let [x, y, z] = pose.position;
                let [qx, qy, qz, qw] = pose.orientation;
                let (s, ns) = (pose.stamp_ns / 1_000_000_000, pose.stamp_ns % 1_000_000_000);
                writeln!(tum, "{s}.{ns:09} {x} {y} {z} {qx} {qy} {qz} {qw}").expect("memory");
                poses.push(pose);
            }
        }
        folder.put("poses.tum", tum);
        Self { folder, imu, poses }
    }

    /// All messages, poses of these topics first: recorders write topics in no order of their stamps.
    fn messages(&self, ros2: bool, topics: &[usize]) -> Vec<Message> {
        let mut messages = Vec::new();
        for (number, kind) in (1..).zip(topics) {
            let (_, texts, more) = TYPES[*kind];
            for pose in &self.poses {
                let mut doubles = [&pose.position[..], &pose.orientation].concat();
                doubles.resize(doubles.len() + more, 5.0);
                let frames = &FRAMES[*kind % 2..][..1 + texts];
                let bytes = wire(ros2, pose.stamp_ns, frames, &doubles);
                messages.push((number, (pose.stamp_ns / 1_000_000_000) as u32, bytes));
            }
        }
        for (rate, force) in self.imu.gyroscope.iter().zip(&self.imu.accelerometer) {
            let mut doubles = [0.0; 37];
            doubles[13..16].copy_from_slice(&rate.value);
            doubles[25..28].copy_from_slice(&force.value);
            let bytes = wire(ros2, rate.stamp_ns, &["imu"], &doubles);
            messages.push((0, (rate.stamp_ns / 1_000_000_000) as u32, bytes));
        }
        messages
    }

    fn integrate(&self, file: &str, arguments: &[&str]) -> Said {
        let file = self.folder.at(file);
        run(&[&["integrate", &file, "--samples", "instantaneous"][..], arguments].concat())
    }

    fn json(&self, file: &str, arguments: &[&str]) -> Value {
        let said = self.integrate(file, &[arguments, &["--json"]].concat());
        assert_eq!(said.code, 0, "{file} {arguments:?}: {}", said.err);
        serde_json::from_str(&said.out).expect("JSON")
    }
}

/// The wire form of a stamp, texts and doubles: header and frame first.
fn wire(ros2: bool, stamp_ns: i64, texts: &[&str], doubles: &[f64]) -> Vec<u8> {
    let (sec, nsec) = ((stamp_ns / 1_000_000_000) as u32, (stamp_ns % 1_000_000_000) as u32);
    let mut bytes = [sec.to_le_bytes(), nsec.to_le_bytes()].concat();
    if !ros2 {
        bytes.splice(0..0, [9, 0, 0, 0]);
    }
    for text in texts {
        if ros2 {
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        bytes.extend((text.len() as u32 + u32::from(ros2)).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(ros2.then_some(0));
    }
    if ros2 {
        bytes.resize(bytes.len().next_multiple_of(8), 0);
    }
    bytes.extend(doubles.iter().flat_map(|v| v.to_le_bytes()));
    if ros2 { [&[0, 1, 0, 0], &bytes[..]].concat() } else { bytes }
}

/// Names and types of topics: the IMU's, and those of poses of these types.
fn topics(ros2: bool, poses: &[usize]) -> Vec<(String, String)> {
    let kind = |name: &str| if ros2 { name.replace('/', "/msg/") } else { name.to_owned() };
    let poses = (1..).zip(poses).map(|(n, which)| (format!("/pose{n}"), kind(TYPES[*which].0)));
    std::iter::once(("/imu".to_owned(), kind("sensor_msgs/Imu"))).chain(poses).collect()
}

fn bag(poses: &[usize], messages: &[Message]) -> Vec<u8> {
    let mut records: Vec<Vec<u8>> = (0..)
        .zip(topics(false, poses))
        .map(|(number, (name, kind))| bags::connection(number, &name, &kind))
        .collect();
    let list = records.concat();
    records.extend(messages.iter().map(|(number, sec, payload)| {
        let time = [sec.to_le_bytes(), [0; 4]].concat();
        bags::record(&[("op", &[2]), ("conn", &number.to_le_bytes()), ("time", &time)], payload)
    }));
    bags::closed_bag(&list, &[bags::packed_chunk(bags::Packing::Lz4, &records)])
}

fn mcap(poses: &[usize], messages: &[Message]) -> Vec<u8> {
    let mut records = Vec::new();
    for (number, (name, kind)) in (0..).zip(topics(true, poses)) {
        records.push(mcaps::schema(number + 1, &kind));
        records.push(mcaps::channel(number, number + 1, &name));
    }
    let message = |(number, sec, payload): &Message| mcaps::message(*number as u16, *sec, payload);
    records.extend(messages.iter().map(message));
    mcaps::mcap(&[mcaps::chunk(&records, "zstd")])
}

fn database(poses: &[usize], messages: &[Message]) -> Vec<u8> {
    let topics = topics(true, poses);
    let topics: Vec<_> =
        (0..).zip(&topics).map(|(n, (a, b))| (n, a.as_str(), b.as_str())).collect();
    let message = |(number, sec, payload): &Message| {
        (i64::from(*number), i64::from(*sec) * 1_000_000_000, payload.clone())
    };
    databases::rosbag2(4096, &topics, &messages.iter().map(message).collect::<Vec<_>>())
}

#[test]
fn poses_of_every_type_and_format_give_the_errors_of_the_same_file() {
    let drive = Drive::new();
    let tum = drive.folder.at("poses.tum");
    let expected = drive.json("imu.csv", &["--truth", &tum]);
    assert!(expected["rules"][0]["errors"]["instants"].as_u64() > Some(100), "{expected}");
    for (which, (kind, ..)) in TYPES.iter().enumerate() {
        drive.folder.put("a.bag", bag(&[which], &drive.messages(false, &[which])));
        drive.folder.put("a.mcap", mcap(&[which], &drive.messages(true, &[which])));
        drive.folder.put("a.db3", database(&[which], &drive.messages(true, &[which])));
        for file in ["a.bag", "a.mcap", "a.db3"] {
            let said = drive.integrate(file, &[]);
            assert_eq!(said.code, 0, "{file} {kind}: {}", said.err);
            let taken = format!("of {} are taken for the truth", drive.folder.at(file));
            assert!(
                said.err.contains("the poses of topic /pose1 ("),
                "{file} {kind}: {}",
                said.err
            );
            assert!(said.err.contains(&taken), "{file} {kind}: {}", said.err);
            assert!(said.err.contains("comes from its positions within 0.1 s"), "{}", said.err);
            let twist = said.err.contains("the velocities of topic /pose1 are not used");
            assert_eq!(twist, kind.ends_with("Odometry"), "{}", said.err);
            assert!(!said.err.contains("left out"), "{file} {kind}: {}", said.err);
            let found = drive.json(file, &["--truth-topic", "pose1"]);
            assert_eq!(found["rules"], expected["rules"], "{file} {kind}");
        }
    }
    // Without: it does not begin at rest.
    let said = drive.integrate("a.bag", &["--no-truth"]);
    assert!(said.err.contains("are not at rest"), "{}", said.err);
}

#[test]
fn of_several_topics_none_is_taken_unless_it_is_named() {
    let drive = Drive::new();
    drive.folder.put("a.bag", bag(&[0, 3], &drive.messages(false, &[0, 3])));
    drive.folder.put("a.db3", database(&[0, 3], &drive.messages(true, &[0, 3])));
    for (file, list) in [
        ("a.bag", "/pose1 (geometry_msgs/PoseStamped), /pose2 (nav_msgs/Odometry)"),
        ("a.db3", "/pose1 (geometry_msgs/msg/PoseStamped), /pose2 (nav_msgs/msg/Odometry)"),
    ] {
        let still = ["--start", "rest", "--rest", "0.1"];
        let path = drive.folder.at(file);
        let several = format!("{path} has several topics of poses: {list}");
        let said = drive.integrate(file, &["--start", "truth"]);
        assert_eq!((said.code, said.err.lines().count()), (2, 1), "{}", said.err);
        assert!(said.err.contains(&several) && said.err.contains("--truth-topic TOPIC"));
        // It goes on to say that an ellipse is no rest.
        assert!(drive.integrate(file, &still).err.contains("are not at rest"));
        let named = drive.json(file, &["--truth-topic", "/pose2"]);
        assert_eq!(named["truth"], format!("topic /pose2 of {path}"));
    }
    for (name, code, sentence) in [
        ("/pose3", 2, "has no topic /pose3; it has /imu"),
        ("/imu", 2, "holds sensor_msgs/Imu, and no poses in a layout that is known"),
    ] {
        let said = drive.integrate("a.bag", &["--truth-topic", name]);
        assert_eq!((said.code, said.err.lines().count()), (code, 1), "{}", said.err);
        assert!(said.err.contains(sentence), "{}", said.err);
    }
    let said = drive.integrate("imu.csv", &["--truth-topic", "/pose1"]);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("is no recording of ROS"), "{}", said.err);
}

#[test]
fn a_truth_beside_the_recording_comes_first() {
    let drive = Drive::new();
    drive.folder.put("a.bag", bag(&[0], &drive.messages(false, &[0])));
    std::fs::copy(drive.folder.at("true.csv"), drive.folder.at("a.truth.csv")).expect("copied");
    let json = drive.json("a.bag", &[]);
    assert_eq!(json["truth"], drive.folder.at("a.truth.csv"));
}

#[test]
fn several_topics_at_rest_are_listed_and_it_goes_on() {
    let folder = Folder::new();
    let mut messages: Vec<Message> = Vec::new();
    for k in 0..600_u32 {
        let stamp_ns = 1_000_000_000 + i64::from(k) * 5_000_000;
        let mut doubles = [0.0; 37];
        doubles[27] = 9.81;
        messages.push((0, 1, wire(false, stamp_ns, &["imu"], &doubles)));
    }
    let path = folder.put("a.bag", bag(&[0, 1], &messages));
    let said = run(&["integrate", &path, "--samples", "instantaneous"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.err.contains("has several topics of poses: /pose1 ("), "{}", said.err);
    assert!(said.err.contains("compare with one by --truth-topic TOPIC"), "{}", said.err);
}

#[test]
fn messages_that_are_cut_are_left_out_and_counted() {
    let drive = Drive::new();
    for ros2 in [false, true] {
        let mut messages = drive.messages(ros2, &[3]);
        let (poses, whole) = (drive.poses.len(), messages[0].2.len());
        // Every length that a message can be cut to, and then some that are whole.
        let cuts = 100.min(poses - 30);
        for (k, (_, _, bytes)) in messages.iter_mut().skip(10).take(cuts).enumerate() {
            bytes.truncate(whole * k / cuts);
        }
        let (file, bytes) =
            if ros2 { ("a.mcap", mcap(&[3], &messages)) } else { ("a.bag", bag(&[3], &messages)) };
        drive.folder.put(file, bytes);
        let said = drive.integrate(file, &[]);
        assert_eq!(said.code, 0, "{}", said.err);
        let sentence = format!(
            "has {cuts} messages that are not of the type that their topic says: they are left out"
        );
        assert!(said.err.contains(&sentence), "{}", said.err);
        let json = drive.json(file, &[]);
        let instants = json["rules"][0]["errors"]["instants"].as_u64();
        assert_eq!(instants, Some((poses - cuts - 1) as u64), "{json}");
    }
}
