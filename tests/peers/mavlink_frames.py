#!/usr/bin/env python3
"""The frames of imu-tools/src/live/protocol/mavlink/tests.rs, as pymavlink writes them.

pip install pymavlink; python3 tests/peers/mavlink_frames.py
"""
from pymavlink.dialects.v10 import common as version_1
from pymavlink.dialects.v20 import common as version_2


def show(name, frame):
    print(f"#[rustfmt::skip]\nconst {name}: [u8; {len(frame)}] = [")
    for start in range(0, len(frame), 14):
        print("    " + " ".join(f"0x{byte:02X}," for byte in frame[start : start + 14]))
    print("];")


for name, dialect in (("V1", version_1), ("V2", version_2)):
    link = dialect.MAVLink(None, srcSystem=3, srcComponent=7)
    axes = (10, -20, -1000, 1, -2, 300, 4, 5, 6)
    precise = (0.5, -0.25, -9.75, 0.125, -0.0625, 2.0, 0, 0, 0, 1013.25, 0, 0, 33.5)
    messages = {
        "HEARTBEAT": dialect.MAVLink_heartbeat_message(2, 3, 0, 0, 3, 3),
        "RAW_IMU": link.raw_imu_encode(123456789012, *axes),
        "SCALED_IMU": link.scaled_imu_encode(4000000000, *axes),
        "HIGHRES_IMU": link.highres_imu_encode(987654321, *precise, 0x103F),
    }
    for number, (kind, message) in enumerate(messages.items()):
        link.seq = 200 + number
        show(f"{kind}_{name}", message.pack(link))

link = version_2.MAVLink(None, srcSystem=3, srcComponent=7)
link.signing.secret_key = bytes(range(32))
link.signing.sign_outgoing = True
link.signing.link_id = 1
link.signing.timestamp = 1
show("SIGNED", link.scaled_imu2_encode(5, 1, 2, 3, 4, 5, 6, 0, 0, 0, 2150).pack(link))
