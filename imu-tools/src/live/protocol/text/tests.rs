use super::super::{Protocol, tests};
use crate::live::{Kind, Message};
use crate::recording::{ForceUnit, RateUnit, ReadOptions};

fn read(text: &str) -> Vec<Message> {
    tests::decoded(Protocol::Text, text.as_bytes())
}

/// What came of text that is read with columns told.
fn read_with(columns: &str, text: &str) -> Vec<Message> {
    let columns = Some(columns.into());
    let options = ReadOptions { columns, ..ReadOptions::default() };
    tests::decoded_with(Protocol::Text, &options, text.as_bytes())
}

#[test]
fn a_message_comes_back_bit_for_bit() {
    for kind in [Kind::Rates, Kind::Increments { over_s: None }] {
        let sent = Message { kind, count: None, ..tests::message(3) };
        let gyroscope_alone = Message { accelerometer: None, celsius: None, ..sent };
        let mut bytes = Vec::new();
        super::encode_header(kind, &mut bytes);
        super::encode(&sent, &mut bytes);
        super::encode(&gyroscope_alone, &mut bytes);
        assert_eq!(tests::decoded(Protocol::Text, &bytes), [sent, gyroscope_alone]);
    }
}

#[test]
fn a_header_in_any_order_and_unit_is_learnt_and_may_change() {
    let messages = read(
        "acc_x [g],acc_y [g],acc_z [g],gx [deg/s],gy [deg/s],gz [deg/s]\n\
         0,0,1,180,0,-180\n\
         Booting, please wait...\n\
         time_ms;gx;gy;gz\n\
         12;1,5;2;3\n",
    );
    let [first, second] = messages.try_into().unwrap();
    let pi = 180.0 * RateUnit::DegPerS.to_rad_s();
    assert_eq!(first.accelerometer, Some([0.0, 0.0, ForceUnit::G.to_m_s2()]));
    assert_eq!(first.gyroscope, Some([pi, 0.0, -pi]));
    assert_eq!(first.ticks, None);
    assert_eq!(second.accelerometer, None);
    assert_eq!(second.gyroscope, Some([1.5, 2.0, 3.0]));
    let ticks = second.ticks.unwrap();
    assert_eq!((ticks.value, ticks.wraps_at), (12_000_000, Some(1_000_000 << 32)));
}

#[test]
fn columns_are_told_or_customary_or_unknown() {
    // What is under way when listening starts is left out.
    let text = "9 9 9 9 9 9\n1 2 3 4 5 6\n7 8 9 10 11 12\n";
    assert_eq!(read(text), []);
    let messages = read_with("ax,ay,az,gx,gy,gz", text);
    assert_eq!(messages.len(), 2);
    assert_eq!(messages[0].gyroscope, Some([4.0, 5.0, 6.0]));
    let seven = read("\n0.00,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n");
    assert_eq!(seven.len(), 2);
    assert_eq!(seven[1].accelerometer, Some([4.0, 5.0, 6.0]));
}

#[test]
fn a_row_may_have_more_fields_than_were_told_as_many_as_others_have() {
    let (three, joined) = ("1,2,3\n", "1,2,31,2,3\n");
    let six = "1,2,3,4,5,6\n";
    for (rows, wanted) in [
        (&[three, three, joined, three, "1,2,3,4\n"][..], 3),
        // The first row may be two, whatever it has.
        (&[joined, three, three, joined], 2),
        (&[six, six, "1,2,3,4,5,61,2,3,4,5,6\n", six], 2),
        (&["1,2,3,\n", "1,2,3,\n", "1,2,3,4\n", "1,2,3,4,5\n"], 2),
        // Fields that come at times only, in turn even.
        (&[three, three, three, six].repeat(16), 64 - 7),
        (&["1,2,3,4\n", "1,2,3,4,5\n"].repeat(40), 80 - 14),
    ] {
        let messages = read_with("ax,ay,az", &format!("\n{}", rows.concat()));
        assert_eq!(messages.len(), wanted, "{rows:?}");
        assert!(messages.iter().all(|m| m.accelerometer == Some([1.0, 2.0, 3.0])), "{rows:?}");
    }
}

#[test]
fn the_unit_of_time_is_learnt_from_its_spacing() {
    let rows: String = (0..40).map(|i| format!("{},1,2,3\n", 5_000 + i * 5_000)).collect();
    let messages = read(&format!("t,gx,gy,gz\n{rows}"));
    assert_eq!(messages.len(), 40);
    assert_eq!(messages[15].ticks, None);
    assert_eq!(messages[16].ticks.unwrap().value, 85_000 * 1_000);
}

/// Programs in C send the end of a string with it.
#[test]
fn nuls_at_the_ends_of_lines_are_blanks() {
    let messages = read("gx,gy,gz,ax,ay,az\r\n\0 1,2,3,4,5,6\0\r\n\0\0 1,2,3,\0 4,5,6\r\n");
    assert_eq!(messages.len(), 1);
    assert_eq!(messages[0].accelerometer, Some([4.0, 5.0, 6.0]));
}

#[test]
fn damaged_lines_are_left_out_whole() {
    let header = "gx,gy,gz,ax,ay,az\n";
    for damaged in [
        "1,2,3,4,5\n",
        "1,2,x,4,5,6\n",
        "1,2,3,4,5,61,2,3,4,5,6\n",
        // Two lines, the end of the first lost.
        "1,21,2,3,4,5,6\n",
        "1,2,3,4,51,2,3,4,5,6\n",
        "1,2,3,4,\u{7},6\n",
        &format!("{}\n", "1".repeat(1500)),
    ] {
        let messages = read(&format!("{header}{damaged}1,2,3,4,5,6\n"));
        assert_eq!(messages.len(), 1, "{damaged:?}");
        assert_eq!(messages[0].gyroscope, Some([1.0, 2.0, 3.0]));
    }
}

/// A line is as long however much of what follows it is at hand.
#[test]
fn a_line_is_no_longer_in_a_piece_than_in_many() {
    for (padding, wanted) in [(1024 - 12, 2), (1024 - 11, 1), (1500, 1)] {
        let row = format!("1,2,3,4,5,{}6\n", "0".repeat(padding));
        let text = format!("gx,gy,gz,ax,ay,az\n{row}1,2,3,4,5,6\n");
        for piece in [1, 67, 1000, text.len()] {
            let options = ReadOptions::default();
            let messages = tests::in_pieces(Protocol::Text, &options, text.as_bytes(), piece);
            assert_eq!(messages.len(), wanted, "{padding} {piece}");
        }
    }
}

#[test]
fn wrong_columns_are_a_usage_error() {
    let columns = Some("t,gx,gy".into());
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let error = super::Text::new(&options).err().unwrap();
    assert_eq!(error.exit_code(), 2);
    assert!(
        error.to_string().starts_with("--columns: each sensor needs its x, y and z"),
        "{error}"
    );
}
