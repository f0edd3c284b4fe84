#!/usr/bin/env python3
"""Compares what `imu` reads from PX4 logs with what PX4's own reader does.

Usage: check_ulog.py IMU_BINARY [LOG.ulg ...]
       check_ulog.py --write FOLDER

Writes logs with every source of samples, several instances, padding that was left out, marks,
dropouts, a cut end and a damaged stretch, and reads them with PyPI's `pyulog` (pip install pyulog;
1.3.0 is known to work) and with `imu convert LOG OUT.csv`. Every topic of an IMU in a log is
compared by itself: stamps must be equal to the nanosecond, values to the bit. Of a damaged log `imu`
may read more than pyulog, which goes on at the next mark only, nothing that is not in the whole log,
and of what pyulog reads rightly all but the message before the damage.

Logs that are named are compared in the same way: of flights, say, or `data/sample_log_small.ulg` of
the crate yule_log. With --write, the logs are left in a folder: something for a fuzzer to start from.

Prints one line a comparison; leaves with 1 if one failed.
"""

import contextlib
import csv
import io
import pathlib
import struct
import subprocess
import sys
import tempfile

MAGIC = b"ULog\x01\x12\x35\x01"
SYNC = bytes([0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12])
# Where the damaged log is damaged.
PLACES = 20
SENSOR = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;"
    "float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t samples;"
    "uint8_t[4] _padding0;"
)
FIFO = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float dt;float scale;"
    "int16_t[32] x;int16_t[32] y;int16_t[32] z;uint8_t samples;uint8_t[3] _padding0;"
)
FORMATS = {
    "sensor_gyro": SENSOR,
    "sensor_accel": SENSOR,
    "sensor_gyro_fifo": FIFO,
    "sensor_accel_fifo": FIFO,
    "vehicle_imu": "uint64_t timestamp;uint64_t timestamp_sample;uint32_t accel_device_id;"
    "uint32_t gyro_device_id;float[3] delta_angle;float[3] delta_velocity;uint16_t delta_angle_dt;"
    "uint16_t delta_velocity_dt;uint8_t delta_velocity_clipping;uint8_t[3] _padding0;",
    "sensor_combined": "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;"
    "int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;"
    "uint32_t accelerometer_integral_dt;uint8_t accelerometer_clipping;uint8_t[3] _padding0;",
    "pose_pair": "uint64_t timestamp;pose[2] poses;float quality;",
    "pose": "float[3] position;double heading;uint8_t[4] _padding0;",
}


def message(kind, body):
    return struct.pack("<HB", len(body), ord(kind)) + body


def numbers():
    """Numbers without end that look like noise, the same every time."""
    state = 1
    while True:
        state = state * 6364136223846793005 + 1442695040888963407 & (1 << 64) - 1
        yield (state >> 40) / (1 << 23) - 1.0


def fields(topic, at, noise):
    """The fields of one message taken at `at` microseconds."""
    n = [next(noise) for _ in range(6)]
    if topic in ("sensor_gyro", "sensor_accel"):
        return struct.pack("<QQI4fI4B", at + 300, at, 7, *n[:4], 0, 0, 0, 0, 1)
    if topic.endswith("_fifo"):
        count = 12 + int(abs(n[0]) * 5)
        counts = [int(next(noise) * 30000) for _ in range(96)]
        return struct.pack("<QQI2f96hB", at + 300, at, 7, 124.7, 0.00106, *counts, count)
    if topic == "vehicle_imu":
        return struct.pack("<QQII6fHHB", at + 300, at, 8, 7, *n, 3999, 4001, 0)
    if topic == "sensor_combined":
        relative = 0x7FFFFFFF if n[0] > 0.9 else int(n[0] * 900)
        return struct.pack("<Q3fIi3fIB", at, *n[:3], 5000, relative, *n[3:], 5000, 0)
    return struct.pack("<Q3fd4x3fd4xf", at, *n[:3], 1.0, *n[3:], 2.0, 3.0)


def log(topics, seconds):
    """A log of these (topic, instance, interval in µs), with marks, lines and a dropout."""
    out = [MAGIC, struct.pack("<Q", 20_000_000), message("B", bytes(40))]
    out.append(message("I", b"\x10char[3] sys_namePX4"))
    out += [message("F", f"{name}:{text}".encode()) for name, text in FORMATS.items()]
    out.append(message("P", b"\x0dint32_t A_B_C\x01\x00\x00\x00"))
    for number, (topic, instance, _) in enumerate(topics):
        out.append(message("A", struct.pack("<BH", instance, number) + topic.encode()))
    due = [(20_000_000 + 17 * i, i) for i in range(len(topics))]
    noise, written = numbers(), 0
    while True:
        at, number = min(due)
        if at > 20_000_000 + seconds * 1_000_000:
            return b"".join(out)
        topic, _, interval = topics[number]
        out.append(message("D", struct.pack("<H", number) + fields(topic, at, noise)))
        due[number] = (at + interval, number)
        written += 1
        if written % 50 == 0:
            out.append(message("S", SYNC))
        if written % 333 == 0:
            out.append(message("L", b"6" + struct.pack("<Q", at) + b"[commander] still"))
            out.append(message("O", struct.pack("<H", 12)))


def logs():
    """Logs by name."""
    sensors = [(f"sensor_{s}", i, 5000 - i) for i in range(3) for s in ("gyro", "accel")]
    flight = sensors + [("pose_pair", 0, 20_000), ("vehicle_imu", 0, 4000)]
    flight += [("vehicle_imu", 1, 4000), ("sensor_combined", 0, 5000)]
    fifo = [("sensor_gyro_fifo", 0, 2000), ("sensor_accel_fifo", 1, 2000), ("sensor_gyro", 0, 10**6)]
    whole = log(flight, 30)
    hurt = bytearray(whole)
    for at in (200_000 + i * len(hurt) // (PLACES + 2) for i in range(PLACES)):
        hurt[at : at + 700] = bytes(range(200, 250)) * 14
    return {
        "flight": whole,
        "fifo": log(fifo, 10),
        "cut": whole[: len(whole) * 2 // 3 - 1],
        "damaged": bytes(hurt),
    }


def by_pyulog(path):
    """Samples of each topic's instance: {label: {sensor: [(stamp, x, y, z)]}}."""
    from pyulog import ULog

    with contextlib.redirect_stdout(io.StringIO()):
        data_list = ULog(str(path)).data_list
    found = {}

    def rows(stamps, axes):
        stamps = [int(stamp) * 1000 for stamp in stamps]
        return list(zip(stamps, *([float(v) for v in axis] for axis in axes)))

    for topic in data_list:
        data, sides = topic.data, {}
        stamps = data.get("timestamp_sample", data["timestamp"])
        sensor = "gyro" if topic.name.startswith("sensor_gyro") else "accel"
        if topic.name in ("sensor_gyro", "sensor_accel"):
            sides[sensor] = rows(stamps, [data[axis] for axis in "xyz"])
        elif topic.name in ("sensor_gyro_fifo", "sensor_accel_fifo"):
            side = sides[sensor] = []
            for i, last in enumerate(stamps):
                count, dt = int(data["samples"][i]), float(data["dt"][i])
                for k in range(count):
                    before = (count - 1 - k) * dt * 1e3
                    xyz = (data[f"{axis}[{k}]"][i] for axis in "xyz")
                    stamp = int(last) * 1000 - int(before + 0.5)
                    side.append((stamp, *(float(v) * float(data["scale"][i]) for v in xyz)))
        elif topic.name == "vehicle_imu":
            for side, name in (("gyro", "delta_angle"), ("accel", "delta_velocity")):
                dt = [float(v) * 1e-6 for v in data[f"{name}_dt"]]
                axes = [[float(v) / t for v, t in zip(data[f"{name}[{i}]"], dt)] for i in range(3)]
                sides[side] = rows(stamps, axes)
        elif topic.name == "sensor_combined":
            sides["gyro"] = rows(stamps, [data[f"gyro_rad[{i}]"] for i in range(3)])
            later = [int(v) for v in data["accelerometer_timestamp_relative"]]
            forces = rows(stamps, [data[f"accelerometer_m_s2[{i}]"] for i in range(3)])
            moved = [(f[0] + 1000 * t, *f[1:]) for f, t in zip(forces, later) if t != 0x7FFFFFFF]
            sides["accel"] = moved
        if sides:
            found[f"{topic.name}:{topic.multi_id}"] = sides
    return found


def by_imu(imu, path, gyro, accel, folder):
    """The same samples by `imu convert`."""
    table = f"{folder}/out.csv"
    command = [imu, "convert", "--force", path, table, "--topic", f"{gyro},{accel}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    sides = {"gyro": [], "accel": []}
    with open(table, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        for row in rows:
            for side, values in (("gyro", row[1:4]), ("accel", row[4:7])):
                if values[0]:
                    sides[side].append((int(row[0]), *(float(v) for v in values)))
    return sides


def main():
    if sys.argv[1:2] == ["--write"] and len(sys.argv) == 3:
        for name, content in logs().items():
            pathlib.Path(sys.argv[2], f"{name}.ulg").write_bytes(content)
        return
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    imu = pathlib.Path(sys.argv[1]).resolve()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        cases = []
        for name, content in logs().items():
            path = pathlib.Path(folder, f"{name}.ulg")
            path.write_bytes(content)
            cases.append(path)
        whole = by_pyulog(cases[0])
        for path in cases + [pathlib.Path(path) for path in sys.argv[2:]]:
            damaged = path.name == "damaged.ulg" and path in cases
            found = by_pyulog(path)
            gyros = [label for label, sides in found.items() if "gyro" in sides]
            accels = [label for label, sides in found.items() if "accel" in sides]
            if not gyros or not accels:
                print(f"skip  {path.name}: pyulog finds no topics of an IMU")
                continue
            for i in range(max(len(gyros), len(accels))):
                pair = {"gyro": gyros[i % len(gyros)], "accel": accels[i % len(accels)]}
                try:
                    got = by_imu(imu, path, pair["gyro"], pair["accel"], folder)
                except ValueError as error:
                    failed += 1
                    print(f"FAIL  {path.name}: {error}")
                    continue
                for side, label in pair.items():
                    # A table has its rows in the order of their stamps.
                    want, have = sorted(found[label][side]), sorted(got[side])
                    good = want == have
                    if damaged:
                        right, have_set = set(whole[label][side]), set(have)
                        good = have_set <= right and len(set(want) & right - have_set) <= PLACES
                    failed += not good
                    counts = f"{len(have)} samples, pyulog {len(want)}"
                    print(f"{'ok  ' if good else 'FAIL'}  {path.name} {label} {side}: {counts}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
