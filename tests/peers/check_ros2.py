#!/usr/bin/env python3
"""Compares what `imu` reads from ROS 2 recordings, and what it writes, with other programs.

Usage: check_ros2.py IMU_BINARY

Needs PyPI's `rosbags`, `mcap`, `mcap-ros2-support`, `zstandard` and `lz4`:
    pip install rosbags mcap mcap-ros2-support zstandard lz4

- MCAP files by `mcap`: compressed by nothing, zstd and lz4, in chunks and without, with and without
  index and summary, two sensors of different rates on topics of their own among other topics.
- rosbag2 folders by `rosbags`: mcap and sqlite3, compressed by file and by message; in several
  files; without metadata.yaml; databases with large pages, an open write-ahead log, overflow pages.
- What `imu simulate` writes as .mcap, read by `mcap-ros2-support` and by `rosbags`.

Stamps must be equal to the nanosecond and values to the bit. Prints one line a check; leaves with 1
if one failed.
"""

import csv
import math
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer as McapWriter
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
IMU = "sensor_msgs/msg/Imu"
START = 1_700_000_000_000_000_000


def messages(count, gyroscope_every=1, accelerometer_every=1, phase=0):
    """Imu messages: (stamp, rate or None, force or None)."""
    noise = np.random.default_rng(phase)
    rows = []
    for i in range(count):
        stamp = START + phase + i * 5_000_000 + int(noise.integers(-1000, 1000))
        rate = tuple(noise.normal(size=3)) if i % gyroscope_every == 0 else None
        force = tuple(noise.normal(size=3)) if i % accelerometer_every == 0 else None
        rows.append((stamp, rate, force))
    return rows


def serialized(row, frame="base_link", big=False):
    """The CDR form of a message."""
    types = STORE.types
    stamp, rate, force = row
    vector, sec = types["geometry_msgs/msg/Vector3"], stamp // 1_000_000_000
    time = types["builtin_interfaces/msg/Time"](sec=sec, nanosec=stamp % 1_000_000_000)
    given, none = np.zeros(9), np.array([-1.0] + [0.0] * 8)
    message = types[IMU](
        header=types["std_msgs/msg/Header"](stamp=time, frame_id=frame),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=none,
        angular_velocity=vector(*(float(v) for v in rate or (9.0, 9.0, 9.0))),
        angular_velocity_covariance=given if rate else none,
        linear_acceleration=vector(*(float(v) for v in force or (9.0, 9.0, 9.0))),
        linear_acceleration_covariance=given if force else none,
    )
    return bytes(STORE.serialize_cdr(message, IMU, little_endian=not big))


def text(value):
    """A message of another topic."""
    return bytes(STORE.serialize_cdr(STORE.types["std_msgs/msg/String"](data=value), "std_msgs/msg/String"))


def joined(rows):
    """What a table of both sensors holds: stamp to rate and force."""
    table = {}
    for stamp, rate, force in rows:
        old = table.get(stamp, (None, None))
        table[stamp] = (rate or old[0], force or old[1])
    return {stamp: pair for stamp, pair in table.items() if pair != (None, None)}


def read(imu, path, folder, *flags):
    """What `imu convert` makes of a recording, and what it said."""
    table = pathlib.Path(folder) / "out.csv"
    table.unlink(missing_ok=True)
    done = subprocess.run([imu, "convert", "--force", *flags, path, table], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    with open(table, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        values = {}
        for row in rows:
            cells = [float(cell) if cell else math.nan for cell in row[1:7]]
            rate, force = tuple(cells[:3]), tuple(cells[3:])
            whole = [None if any(map(math.isnan, v)) else v for v in (rate, force)]
            values[int(row[0])] = tuple(whole)
    return values, done.stderr


def write_mcap(path, channels, compression, index=True, chunked=True, summary=True):
    """Messages of several channels: {topic: (type, [(time, bytes)])}."""
    with open(path, "wb") as file:
        writer = McapWriter(
            file,
            compression=compression,
            chunk_size=64 * 1024,
            index_types=IndexType.ALL if index else IndexType.NONE,
            repeat_channels=summary,
            repeat_schemas=summary,
            use_statistics=summary,
            use_summary_offsets=summary,
            use_chunking=chunked,
        )
        writer.start(profile="ros2", library="check_ros2")
        all_messages = []
        for topic, (name, rows) in channels.items():
            definition, _ = STORE.generate_msgdef(name, ros_version=2)
            schema = writer.register_schema(name, "ros2msg", definition.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            all_messages += [(time, channel, data) for time, data in rows]
        for sequence, (time, channel, data) in enumerate(sorted(all_messages)):
            writer.add_message(channel, time, data, time, sequence)
        writer.finish()


def write_rosbag2(path, channels, storage, mode=None):
    """The same as a folder of rosbag2."""
    writer = Writer(path, version=9, storage_plugin=storage)
    if mode:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(topic, name, typestore=STORE)
            for topic, (name, _) in channels.items()
        }
        rows = [(time, topic, data) for topic, (_, all_) in channels.items() for time, data in all_]
        for time, topic, data in sorted(rows):
            writer.write(connections[topic], time, data)


def database(path, rows, page, wal=False, padding=0):
    """A rosbag2 database by SQLite itself; with `wal` it is copied while it is open."""
    live = path.with_suffix(".live")
    base = sqlite3.connect(live)
    base.execute(f"PRAGMA page_size={page}")
    if wal:
        base.execute("PRAGMA journal_mode=WAL")
        base.execute("PRAGMA wal_autocheckpoint=200")
    base.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)"
    )
    base.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    base.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    base.execute("INSERT INTO topics VALUES(1,'/imu',?,'cdr','')", (IMU,))
    base.execute("INSERT INTO topics VALUES(2,'/camera','sensor_msgs/msg/Image','cdr','')")
    for i, row in enumerate(rows):
        if i % 7 == 0:
            base.execute(
                "INSERT INTO messages(topic_id,timestamp,data) VALUES(2,?,?)",
                (row[0], bytes(50_000)),
            )
        base.execute(
            "INSERT INTO messages(topic_id,timestamp,data) VALUES(1,?,?)",
            (row[0], serialized(row, "f" * (9 + padding))),
        )
        if i % 50 == 0:
            base.commit()
    base.commit()
    shutil.copy(live, path)
    log = pathlib.Path(f"{live}-wal")
    if wal:
        shutil.copy(log, f"{path}-wal")
    base.close()
    live.unlink()
    return wal


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    imu = pathlib.Path(sys.argv[1]).resolve()
    failed = 0

    def check(name, expected, path, *flags, said=""):
        nonlocal failed
        try:
            values, words = read(imu, path, folder, *flags)
        except ValueError as error:
            values, words = {}, str(error)
        good = values == expected and said in words
        failed += not good
        detail = f": {len(values)} of {len(expected)} rows" + ("" if good else f": {words.strip()}")
        print(f"{'ok  ' if good else 'FAIL'}  {name}{detail}")

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        both = messages(3000)
        mixed = messages(3000, accelerometer_every=4)
        rates = [row[:2] + (None,) for row in messages(2000)]
        forces = [(row[0], None, row[2]) for row in messages(2000, 9, 4, phase=2_500_000)]
        forces = [row for row in forces if row[2]]
        words = [(row[0], text("x" * (i % 5000))) for i, row in enumerate(both)]
        data = lambda rows, **kw: [(row[0], serialized(row, **kw)) for row in rows]
        one = {"/imu": (IMU, data(both)), "/words": ("std_msgs/msg/String", words)}
        two = {
            "/camera/gyro/sample": (IMU, data(rates)),
            "/camera/accel/sample": (IMU, data(forces)),
            "/words": ("std_msgs/msg/String", words),
        }

        path = folder / "a.mcap"
        for compression in (CompressionType.NONE, CompressionType.ZSTD, CompressionType.LZ4):
            for chunked, index, summary in ((1, 1, 1), (1, 0, 1), (1, 0, 0), (0, 1, 1), (0, 0, 0)):
                kind = f"mcap, {compression.name}, chunks {chunked}, index {index}, summary {summary}"
                how = dict(chunked=bool(chunked), index=bool(index), summary=bool(summary))
                write_mcap(path, one, compression, **how)
                check(f"{kind}: one topic", joined(both), path)
                write_mcap(path, two, compression, **how)
                topics = ("--topic", "camera/gyro/sample,camera/accel/sample")
                check(f"{kind}: two", joined(rates + forces), path, *topics)
        write_mcap(path, {"/imu": (IMU, data(mixed))}, CompressionType.ZSTD)
        check("mcap: rates that differ on one topic", joined(mixed), path)
        write_mcap(path, {"/imu": (IMU, data(both, big=True, frame=""))}, CompressionType.ZSTD)
        check("mcap: big-endian, no frame", joined(both), path)

        for storage in (StoragePlugin.MCAP, StoragePlugin.SQLITE3):
            for mode in (None, CompressionMode.FILE, CompressionMode.MESSAGE, CompressionMode.STORAGE):
                if mode == CompressionMode.STORAGE and storage != StoragePlugin.MCAP:
                    continue
                kind = f"rosbag2, {storage.name}, compression {mode.name if mode else 'none'}"
                bag = folder / "bag"
                write_rosbag2(bag, one, storage, mode)
                check(kind, joined(both), bag)
                (bag / "metadata.yaml").unlink()
                check(f"{kind}, no metadata", joined(both), bag, said="no metadata.yaml")
                shutil.rmtree(bag)

        for page in (512, 4096, 65536):
            for wal in (False, True):
                path = folder / "a.db3"
                database(path, both, page, wal)
                check(f"sqlite, pages of {page}, log {wal}", joined(both), path)
                if wal:
                    pathlib.Path(f"{path}-wal").unlink()
        database(path, both, 512, padding=2000)
        check("sqlite, messages on overflow pages", joined(both), path)
        with open(path, "rb") as file:
            pipe = subprocess.run(
                [imu, "convert", "--force", "-", folder / "pipe.csv"], stdin=file, capture_output=True
            )
        same = pipe.returncode == 0 and (folder / "pipe.csv").read_bytes() == (folder / "out.csv").read_bytes()
        failed += not same
        print(f"{'ok  ' if same else 'FAIL'}  sqlite, through a pipe")
        if not same:
            print(pipe.stderr.decode())

        scene = ["simulate", "mid", "--duration", "60s", "--rate", "200", "--seed", "7", "-o"]
        for output in ("ours.mcap", "ours.csv"):
            subprocess.run([imu, *scene, folder / output], check=True, capture_output=True)
        write_mcap(path := folder / "mixed.mcap", {"/imu": (IMU, data(mixed))}, CompressionType.NONE)
        subprocess.run([imu, "convert", "--force", path, folder / "ours_mixed.mcap"], check=True, capture_output=True)
        truth = {}
        with open(folder / "ours.csv", newline="") as file:
            rows = csv.reader(file)
            next(rows)
            for row in rows:
                cells = tuple(float(v) for v in row[1:])
                truth[int(row[0])] = (cells[:3], cells[3:6])

        def row(m, time):
            stamp = m.header.stamp.sec * 1_000_000_000 + m.header.stamp.nanosec
            if stamp != time or m.header.frame_id != "imu":
                raise ValueError(f"unexpected frame or time at {stamp}")
            w, a = m.angular_velocity, m.linear_acceleration
            return stamp, (
                (w.x, w.y, w.z) if m.angular_velocity_covariance[0] != -1 else None,
                (a.x, a.y, a.z) if m.linear_acceleration_covariance[0] != -1 else None,
            )

        for path, expected in ((folder / "ours.mcap", truth), (folder / "ours_mixed.mcap", joined(mixed))):
            with open(path, "rb") as file:
                reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
                counted = reader.get_summary().statistics.message_count
                found = dict(
                    row(m.decoded_ros_message if hasattr(m, "decoded_ros_message") else m[3], m[2].log_time)
                    for m in reader.iter_decoded_messages(topics=["/imu"])
                )
            with AnyReader([path], default_typestore=STORE) as reader:
                again = dict(
                    row(reader.deserialize(raw, connection.msgtype), time)
                    for connection, time, raw in reader.messages()
                )
            for name, values in (("mcap-ros2-support", found), ("rosbags", again)):
                good = values == expected and counted == len(expected)
                failed += not good
                print(f"{'ok  ' if good else 'FAIL'}  {path.name} by {name}: {len(values)} of {len(expected)}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
