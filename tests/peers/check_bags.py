#!/usr/bin/env python3
"""Compares bags that `imu` writes with two other readers of the format.

Usage: check_bags.py IMU_BINARY

Simulates a minute as a bag and the same as a CSV, and reads the bag back with PyPI's `rosbags`
(pip install rosbags) and with ROS 1's own `rosbag` (Debian: apt install python3-rosbag rosbag).
Stamps must be equal to the nanosecond and values to the bit. `rosbag check` must be content. What
is not installed is skipped; if neither reader is there, that is a failure.

Prints one line a check; leaves with 1 if one failed.
"""

import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROSBAG_READER = """
import sys, rosbag
for topic, m, t in rosbag.Bag(sys.argv[1]).read_messages():
    w, a = m.angular_velocity, m.linear_acceleration
    stamp = m.header.stamp.to_nsec()
    print(topic, m.header.frame_id, t.to_nsec() == stamp, stamp,
          *(float.hex(v) for v in (w.x, w.y, w.z, a.x, a.y, a.z)))
"""


def expected(path):
    """The rows of the CSV: stamp and six values."""
    with open(path, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        return [(int(row[0]), *(float(v) for v in row[1:])) for row in rows]


def with_rosbags(path):
    """Rows by PyPI's rosbags; None if it is not installed."""
    try:
        from rosbags.rosbag1 import Reader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        return None
    store = get_typestore(Stores.ROS1_NOETIC)
    rows = []
    with Reader(path) as reader:
        for connection, time, data in reader.messages():
            m = store.deserialize_ros1(data, connection.msgtype)
            stamp = m.header.stamp.sec * 1_000_000_000 + m.header.stamp.nanosec
            if connection.topic != "/imu" or m.header.frame_id != "imu" or time != stamp:
                raise ValueError(f"unexpected topic, frame or time at {stamp}")
            w, a = m.angular_velocity, m.linear_acceleration
            rows.append((stamp, w.x, w.y, w.z, a.x, a.y, a.z))
    return rows


def with_rosbag(path):
    """Rows by ROS 1's rosbag, which lives in the system's Python; None if it is not installed."""
    python = "/usr/bin/python3"
    probe = [python, "-c", "import rosbag"]
    if not shutil.which(python) or subprocess.run(probe, capture_output=True).returncode:
        return None
    done = subprocess.run(
        [python, "-c", ROSBAG_READER, path], capture_output=True, text=True, check=True
    )
    rows = []
    for line in done.stdout.splitlines():
        topic, frame, same, stamp, *values = line.split()
        if (topic, frame, same) != ("/imu", "imu", "True"):
            raise ValueError(f"unexpected topic, frame or time: {line}")
        rows.append((int(stamp), *(float.fromhex(v) for v in values)))
    return rows


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    imu = pathlib.Path(sys.argv[1]).resolve()
    failed = compared = 0

    def report(name, good, detail=""):
        nonlocal failed
        failed += not good
        print(f"{'ok  ' if good else 'FAIL'}  {name}{detail}")

    with tempfile.TemporaryDirectory() as folder:
        bag, table = f"{folder}/a.bag", f"{folder}/a.csv"
        for output in (bag, table):
            scene = ["simulate", "mid", "--duration", "60s", "--rate", "200", "--seed", "7"]
            subprocess.run([imu, *scene, "-o", output], check=True, capture_output=True)
        truth = expected(table)
        for name, reader in (("rosbags", with_rosbags), ("python3-rosbag", with_rosbag)):
            try:
                rows = reader(bag)
            except Exception as error:  # A reader that refuses the bag is what we look for.
                report(name, False, f": {error}")
                continue
            if rows is None:
                print(f"skip  {name}: not installed")
                continue
            compared += 1
            report(name, rows == truth, f": {len(rows)} of {len(truth)} messages read")
        if shutil.which("rosbag"):
            for command in ("check", "info"):
                done = subprocess.run(["rosbag", command, bag], capture_output=True, text=True)
                report(f"rosbag {command}", done.returncode == 0, f": {done.stderr.strip()}")
        else:
            print("skip  rosbag check: not installed")
    if not compared:
        report("no other reader is installed", False)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
