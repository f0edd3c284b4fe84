//! NumPy's arrays: every order and type, archives, damage.

use std::io::Write as _;

use imu_tests::recordings::Folder;
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample, SampleKind};

const ROWS: usize = 10_000;

/// What all of these arrays hold: t, gyroscope, accelerometer.
fn rows() -> Vec<[f64; 7]> {
    (0..ROWS)
        .map(|i| {
            // Numbers that single precision holds too.
            let v = (i % 251) as f64 / 64.0;
            [i as f64 / 256.0, v, -v, 2.0 * v, 0.25, v + 1.0, 9.75]
        })
        .collect()
}

fn expected() -> Block {
    let mut block = Block::default();
    for [t, gx, gy, gz, ax, ay, az] in rows() {
        let stamp_ns = (t * 1e9).round() as i64;
        block.gyroscope.push(Sample { stamp_ns, value: [gx, gy, gz] });
        block.accelerometer.push(Sample { stamp_ns, value: [ax, ay, az] });
    }
    block
}

/// An array as NumPy writes it: the header of version 1 padded to 64 bytes.
fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut text = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), data].concat()
}

/// The rows one after the other, or the columns, of these seven.
fn data<const N: usize>(
    columns: &[usize],
    by_column: bool,
    bytes: impl Fn(f64) -> [u8; N],
) -> Vec<u8> {
    let rows = rows();
    if by_column {
        columns.iter().flat_map(|&c| rows.iter().map(move |row| row[c])).flat_map(bytes).collect()
    } else {
        rows.iter().flat_map(|row| columns.iter().map(move |&c| row[c])).flat_map(bytes).collect()
    }
}

const ALL: [usize; 7] = [0, 1, 2, 3, 4, 5, 6];

/// A zip file of arrays, each stored or deflated.
fn npz(arrays: &[(&str, Vec<u8>)], deflated: bool) -> Vec<u8> {
    let (mut zip, mut list) = (Vec::new(), Vec::new());
    for (name, bytes) in arrays {
        let mut sum = flate2::Crc::new();
        sum.update(bytes);
        let packed = if deflated {
            let mut to =
                flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
            to.write_all(bytes).unwrap();
            to.finish().unwrap()
        } else {
            bytes.clone()
        };
        let name = format!("{name}.npy");
        let method: u16 = if deflated { 8 } else { 0 };
        let common = [
            &[20, 0, 0, 0][..],
            &method.to_le_bytes(),
            &[0, 0, 0x21, 0],
            &sum.sum().to_le_bytes(),
            &(packed.len() as u32).to_le_bytes(),
            &(bytes.len() as u32).to_le_bytes(),
            &(name.len() as u16).to_le_bytes(),
            &[0, 0],
        ]
        .concat();
        let at = zip.len() as u32;
        zip.extend([b"PK\x03\x04", &common[..], name.as_bytes(), &packed].concat());
        list.extend(
            [b"PK\x01\x02\x14\0", &common[..], &[0; 10], &at.to_le_bytes(), name.as_bytes()]
                .concat(),
        );
    }
    let count = (arrays.len() as u16).to_le_bytes();
    let (size, at) = ((list.len() as u32).to_le_bytes(), (zip.len() as u32).to_le_bytes());
    zip.extend(list);
    zip.extend([b"PK\x05\x06\0\0\0\0", &count[..], &count, &size, &at, &[0, 0]].concat());
    zip
}

fn read_with(path: &str, options: &ReadOptions) -> Result<(Block, Vec<Note>), Error> {
    let mut source = recording::open(path.as_ref(), options)?;
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
        all.temperature.append(&mut block.temperature);
    }
    Ok((all, source.take_notes()))
}

fn read(path: &str) -> (Block, Vec<Note>) {
    read_with(path, &ReadOptions::default()).unwrap()
}

fn warnings(notes: &[Note]) -> Vec<&str> {
    let mut warnings = Vec::new();
    for note in notes {
        if let Note::Warning(what) = note {
            warnings.push(what.as_str());
        }
    }
    warnings
}

fn refusal(path: &str) -> String {
    read_with(path, &ReadOptions::default()).unwrap_err().to_string()
}

#[test]
fn every_type_and_order() {
    let folder = Folder::new();
    let shape = format!("({ROWS}, 7)");
    let turned = format!("(7, {ROWS})");
    for (name, bytes) in [
        ("f8", npy("'<f8'", false, &shape, &data(&ALL, false, f64::to_le_bytes))),
        ("big", npy("'>f8'", false, &shape, &data(&ALL, false, f64::to_be_bytes))),
        ("f4", npy("'<f4'", false, &shape, &data(&ALL, false, |v| (v as f32).to_le_bytes()))),
        ("bigf4", npy("'>f4'", false, &shape, &data(&ALL, false, |v| (v as f32).to_be_bytes()))),
        ("fortran", npy("'<f8'", true, &shape, &data(&ALL, true, f64::to_le_bytes))),
        ("turned", npy("'<f8'", false, &turned, &data(&ALL, true, f64::to_le_bytes))),
        ("both", npy("'<f8'", true, &turned, &data(&ALL, false, f64::to_le_bytes))),
    ] {
        let (block, notes) = read(&folder.put(&format!("{name}.npy"), &bytes));
        assert!(block == expected(), "{name}");
        assert!(warnings(&notes).is_empty(), "{notes:?}");
    }
}

#[test]
fn other_columns() {
    let folder = Folder::new();
    let with =
        |columns: &str| ReadOptions { columns: Some(columns.into()), ..ReadOptions::default() };
    let order = [4, 5, 6, 1, 2, 3, 0];
    let path = folder.put(
        "order.npy",
        npy("'<f8'", false, &format!("({ROWS}, 7)"), &data(&order, false, f64::to_le_bytes)),
    );
    assert!(read_with(&path, &with("ax,ay,az,gx,gy,gz,t")).unwrap().0 == expected());
    let path = folder.put(
        "four.npy",
        npy("'<f8'", false, &format!("({ROWS}, 4)"), &data(&ALL[..4], false, f64::to_le_bytes)),
    );
    let block = read_with(&path, &with("t,gx,gy,gz")).unwrap().0;
    assert!(block.gyroscope == expected().gyroscope && block.accelerometer.is_empty());
    assert!(refusal(&path).contains("has 4 columns (its shape is [10000, 4])"));
    let error = read_with(&path, &with("t,gx,gy,gz,ax,ay,az")).unwrap_err();
    assert_eq!(error.exit_code(), 2);
}

#[test]
fn structures_by_their_names() {
    let folder = Folder::new();
    let mut bytes = Vec::new();
    for [t, gx, gy, gz, ax, ay, az] in rows() {
        bytes.extend(b"name");
        bytes.extend(((t * 1e9) as i64).to_le_bytes());
        [gx, gy, gz, ax, ay, az].iter().for_each(|v| bytes.extend((*v as f32).to_le_bytes()));
        bytes.extend(25.5_f64.to_le_bytes());
    }
    let descr = "[('label', '|S4'), ('time', '<i8'), ('gyro', '<f4', (3,)), ('acc_x', '<f4'), \
                 ('acc_y', '<f4'), ('acc_z', '<f4'), ('temp', '<f8')]";
    let path = folder.put("s.npy", npy(descr, false, &format!("({ROWS},)"), &bytes));
    let (block, _) = read(&path);
    assert!(block.gyroscope == expected().gyroscope);
    assert!(block.accelerometer == expected().accelerometer);
    assert_eq!((block.temperature.len(), block.temperature[7].celsius), (ROWS, 25.5));
}

#[test]
fn archives() {
    let folder = Folder::new();
    let whole = npy("'<f8'", false, &format!("({ROWS}, 7)"), &data(&ALL, false, f64::to_le_bytes));
    let three = format!("({ROWS}, 3)");
    let stamps =
        rows().iter().flat_map(|row| ((row[0] * 1e9) as i64).to_le_bytes()).collect::<Vec<u8>>();
    let separate = [
        (
            "accel",
            npy("'<f4'", false, &three, &data(&[4, 5, 6], false, |v| (v as f32).to_le_bytes())),
        ),
        ("gyro", npy("'<f8'", true, &three, &data(&[1, 2, 3], true, f64::to_le_bytes))),
        ("meta", npy("'<U5'", false, "()", &[0; 20])),
        ("t", npy("'<i8'", false, &format!("({ROWS},)"), &stamps)),
    ];
    let readable = [separate[0].clone(), separate[1].clone(), separate[3].clone()];
    for deflated in [false, true] {
        for (name, arrays) in [("one", &[("arr_0", whole.clone())][..]), ("three", &readable)] {
            let path = folder.put(&format!("{name}{deflated}.npz"), npz(arrays, deflated));
            let (block, notes) = read(&path);
            assert!(block == expected(), "{name} {deflated}");
            assert!(warnings(&notes).is_empty(), "{notes:?}");
        }
        // An array of text beside them is of no interest.
        assert!(read(&folder.put("meta.npz", npz(&separate, deflated))).0 == expected());
    }
}

#[test]
fn damage_costs_what_is_behind_it() {
    let folder = Folder::new();
    let bytes = npy("'<f8'", false, &format!("({ROWS}, 7)"), &data(&ALL, false, f64::to_le_bytes));
    let (block, notes) = read(&folder.put("cut.npy", &bytes[..128 + 56 * 100 + 9]));
    assert_eq!(block.gyroscope[..], expected().gyroscope[..100]);
    assert!(warnings(&notes)[0].contains("is cut off: of its 10000 rows 100"), "{notes:?}");

    // A checksum that is wrong, and deflate that breaks off.
    let mut stored = npz(&[("a", bytes.clone())], false);
    let middle = stored.len() / 2;
    stored[middle] ^= 1;
    let (block, notes) = read(&folder.put("sum.npz", stored));
    assert_eq!(block.gyroscope.len(), ROWS);
    assert!(warnings(&notes)[0].contains("checksum"), "{notes:?}");
    let mut deflated = npz(&[("a", bytes.clone())], true);
    let middle = deflated.len() / 2;
    deflated[middle..middle + 64].fill(0xff);
    let (block, notes) = read(&folder.put("deflate.npz", deflated));
    assert_eq!(block.gyroscope[..2000], expected().gyroscope[..2000]);
    assert!(!warnings(&notes).is_empty());

    let cut = npz(&[("a", bytes)], false);
    assert!(refusal(&folder.put("cut.npz", &cut[..1000])).contains("list of arrays"));
}

#[test]
fn what_cannot_be_read_is_one_sentence() {
    let folder = Folder::new();
    let shape = format!("({ROWS}, 7)");
    let fortran = npy("'<f8'", true, &shape, &data(&ALL, true, f64::to_le_bytes));
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gz.write_all(&fortran).unwrap();
    let one = npy("'<f8'", false, "(3,)", &[0; 24]);
    let two = npy("'<f8'", false, "(2, 3)", &[0; 48]);
    for (name, bytes, part) in [
        ("a.npy.gz", gz.finish().unwrap(), "stored column by column"),
        ("b.npy", npy("'<f8'", false, "(9, 9, 9)", &[]), "no column of time"),
        ("c.npy", npy("'|O'", false, "(9, 7)", &[]), "'|O', objects of Python"),
        ("c.npy", npy("'|O'", false, "(9,)", &[]), "array.astype(float)"),
        ("d.npy", b"\x93NUMPY\x01\x00\xff\xff{".to_vec(), "cut off in its header"),
        ("e.npz", npz(&[], false), "without NumPy arrays"),
        ("f.npz", npz(&[("t", one.clone()), ("gyro", two)], false), "'gyro_x' has 2 rows"),
        ("g.npz", npz(&[("t", one.clone()), ("u", one)], false), "it holds t [3], u [3]"),
    ] {
        let said = refusal(&folder.put(name, bytes));
        assert!(said.contains(part), "{said}");
    }
    // A claim of rows costs no memory, and their absence is told.
    let claim = npy("'<f8'", false, "(999999999999999, 7)", &1.0_f64.to_le_bytes().repeat(14));
    let (block, notes) = read(&folder.put("claim.npy", claim));
    assert_eq!(block.gyroscope.len(), 2);
    assert!(warnings(&notes)[0].contains("is cut off"));
}

#[test]
fn arrays_of_increments_are_divided_by_their_time() {
    let folder = Folder::new();
    let array = |shape: &str, values: &[f64]| {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        npy("'<f8'", false, shape, &bytes)
    };
    let arrays = [
        ("t", array("(2,)", &[0.0, 0.01])),
        ("dtheta", array("(2, 3)", &[0.01, 0.0, 0.02, 0.01, 0.0, 0.02])),
        ("dvel", array("(2, 3)", &[0.0, 0.0, 0.1, 0.0, 0.0, 0.1])),
    ];
    let path = folder.put("increments.npz", npz(&arrays, false));
    let (block, notes) = read(&path);
    assert!(block.gyroscope.iter().all(|sample| sample.value == [1.0, 0.0, 2.0]), "{notes:?}");
    assert!(block.accelerometer.iter().all(|sample| sample.value == [0.0, 0.0, 10.0]));
    let told = |note: &Note| matches!(note, Note::Info(what) if what.contains("each is divided"));
    assert!(notes.iter().any(told), "{notes:?}");
    let source = recording::open(path.as_ref(), &ReadOptions::default()).unwrap();
    assert_eq!(source.samples(), Some(SampleKind::Mean));
}
