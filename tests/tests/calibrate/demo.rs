//! `imu demo` as a user calls it, in an empty folder.

use std::fs;

use imu_tests::command::{imu, said};
use imu_tests::recordings::Folder;

#[test]
fn three_levels_are_compared_and_written() {
    let folder = Folder::new();
    let call = imu().arg("demo").current_dir(folder.path()).output();
    let said = said(&call.expect("imu can be started"));
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    for level in ["low", "mid", "high"] {
        let rows = said.out.lines().filter(|line| line.split_whitespace().next() == Some(level));
        assert_eq!(rows.count(), 4, "N and K of both sensors: {}", said.out);
        let mut names: Vec<_> = fs::read_dir(folder.at(&format!("imu-demo/{level}")))
            .expect("the folder of the level")
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
            .collect();
        names.sort();
        assert_eq!(names, ["allan.csv", "allan.png", "allan.svg", "imu.yaml", "report.html"]);
    }
    // The true N of the middle level, and what is found in four hours (within some 0.1 %).
    let row = said.out.lines().find(|line| line.starts_with("mid")).expect("the gyroscope's N");
    let mut numbers = row.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    let (truth, found) = (numbers.next().unwrap(), numbers.next().unwrap());
    assert_eq!(truth, 0.015, "{row}");
    assert!((found / truth - 1.0).abs() < 5e-3, "{row}");
    let page = fs::read_to_string(folder.at("imu-demo/demo.html")).expect("written");
    assert_eq!(page.matches("4 h at 200 Hz").count(), 3);
    for level in ["low", "mid", "high"] {
        assert!(page.contains(&format!("href=\"{level}/report.html\"")));
    }
}
