//! ROS 1 bags put together by hand: other programs' layouts, and wrong ones.

/// A record with these header fields, in this order.
#[must_use]
pub fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend(((name.len() + 1 + value.len()) as u32).to_le_bytes());
        header.extend([name.as_bytes(), b"=", value].concat());
    }
    let mut record = (header.len() as u32).to_le_bytes().to_vec();
    record.extend(header);
    record.extend((data.len() as u32).to_le_bytes());
    record.extend(data);
    record
}

/// The description of a connection, whose layout has no fingerprint.
#[must_use]
pub fn connection(number: u32, topic: &str, type_name: &str) -> Vec<u8> {
    let mut data = Vec::new();
    for field in [
        format!("topic={topic}"),
        format!("type={type_name}"),
        "md5sum=*".to_owned(),
        "message_definition=...".to_owned(),
    ] {
        data.extend((field.len() as u32).to_le_bytes());
        data.extend(field.as_bytes());
    }
    let number = number.to_le_bytes();
    record(&[("topic", topic.as_bytes()), ("op", &[7]), ("conn", &number)], &data)
}

/// An Imu message at second `sec`, recorded a second later, with its header fields turned by
/// `order`; its doubles are 0, 1, 2, …
#[must_use]
pub fn message(number: u32, sec: u32, order: usize) -> Vec<u8> {
    let mut payload = vec![0; 4];
    payload.extend(sec.to_le_bytes());
    payload.extend([0; 4]);
    payload.extend(3_u32.to_le_bytes());
    payload.extend(b"imu");
    payload.extend((0..37).flat_map(|i| f64::from(i).to_le_bytes()));
    let mut time = (sec + 1).to_le_bytes().to_vec();
    time.extend([0; 4]);
    let number = number.to_le_bytes();
    let mut fields: Vec<(&str, &[u8])> = vec![("op", &[2]), ("conn", &number), ("time", &time)];
    fields.rotate_left(order % 3);
    record(&fields, &payload)
}

/// A chunk of records, not compressed.
#[must_use]
pub fn chunk(records: &[Vec<u8>]) -> Vec<u8> {
    let data = records.concat();
    let size = (data.len() as u32).to_le_bytes();
    record(&[("size", &size), ("compression", b"none"), ("op", &[5])], &data)
}

/// A bag of these records that was never closed.
#[must_use]
pub fn bag(records: &[Vec<u8>]) -> Vec<u8> {
    let (zero, one) = (0_u64.to_le_bytes(), 1_u32.to_le_bytes());
    let header = record(
        &[("op", &[3]), ("index_pos", &zero), ("conn_count", &one), ("chunk_count", &one)],
        &[b' '; 4027],
    );
    [b"#ROSBAG V2.0\n".to_vec(), header, records.concat()].concat()
}
