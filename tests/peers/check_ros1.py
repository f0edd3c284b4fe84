#!/usr/bin/env python3
"""Compares what `imu` reads in ROS 1 bags with what two other readers of the format read.

Usage: check_ros1.py DUMP_BINARY [--bags FOLDER] [--count N] [--seed S] [--keep FOLDER]

DUMP_BINARY prints every sample to the bit: cargo build -p imu-tests --example dump. Generates N
bags (200 by default) of many sizes, chunkings, compressions, orders of header fields, connections
a topic, and with parts of the index left out, half of them with ROS 1's own `rosbag` (Debian: apt
install python3-rosbag python3-sensor-msgs) and half with a small writer of its own (which needs
roslz4 for LZ4), and takes those of FOLDER as well. Each is read by DUMP_BINARY, from the file and
from a pipe, by PyPI's `rosbags` (pip install rosbags) and by `rosbag`. Every sample that another
reader gives must be equal in stamp and bits, in number and order. Bags that both others refuse are
compared with what was written; of bags in FOLDER that both refuse, the number of samples is told.

Prints a line a kind of bag; leaves with 1 if one failed.
"""

import argparse
import bz2
import collections
import json
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

SYSTEM_PYTHON = "/usr/bin/python3"

# Runs in the system's Python, where ROS lives: writes bags as told, and reads bags.
ROSBAG_WORKER = r"""
import json, struct, sys
import rosbag, genpy, rospy
from sensor_msgs.msg import Imu, Temperature
from std_msgs.msg import String

def stamp(ns):
    return genpy.Time(ns // 10**9, ns % 10**9)

def write(path, job):
    with rosbag.Bag(path, "w", compression=job["compression"], chunk_threshold=job["chunk"]) as bag:
        for kind, topic, caller, ns, values in job["messages"]:
            if kind == "imu":
                m = Imu()
                w, a = m.angular_velocity, m.linear_acceleration
                w.x, w.y, w.z, a.x, a.y, a.z = (float.fromhex(v) for v in values)
            elif kind == "temperature":
                m = Temperature(temperature=float.fromhex(values[0]))
            else:
                m = String(values[0])
            if kind != "text":
                m.header.stamp = stamp(ns)
                m.header.frame_id = job["frame"]
            header = {"callerid": caller} if caller else None
            if header is not None:
                header.update(topic=topic, type=m._type, md5sum=m._md5sum,
                              message_definition=m._full_text)
            bag.write(topic, m, stamp(ns), connection_header=header)

def bits(*values):
    return " ".join(struct.pack(">d", v).hex() for v in values)

def read(path):
    g, t = [], []
    with rosbag.Bag(path) as bag:
        for topic, m, when in bag.read_messages():
            if m._type == "sensor_msgs/Imu":
                w, a = m.angular_velocity, m.linear_acceleration
                g.append((topic, m.header.stamp.to_nsec(), bits(w.x, w.y, w.z), bits(a.x, a.y, a.z)))
            elif m._type == "sensor_msgs/Temperature":
                t.append((topic, m.header.stamp.to_nsec(), bits(m.temperature), ""))
    return g, t

for line in sys.stdin:
    job = json.loads(line)
    try:
        answer = write(job["path"], job) if job["do"] == "write" else read(job["path"])
    except Exception as error:
        answer = {"refused": type(error).__name__ + ": " + str(error)}
    print(json.dumps(answer), flush=True)
"""


class Rosbag:
    """ROS 1's own library, in a process of its own."""

    def __init__(self):
        self.process = subprocess.Popen(
            [SYSTEM_PYTHON, "-c", ROSBAG_WORKER],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    def ask(self, **job):
        self.process.stdin.write(json.dumps(job) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def read(self, path):
        answer = self.ask(do="read", path=str(path))
        return answer if isinstance(answer, dict) else tuple([tuple(m) for m in l] for l in answer)


def bits(*values):
    return " ".join(struct.pack(">d", v).hex() for v in values)


def with_rosbags(path):
    """What PyPI's rosbags reads, in the form of `Rosbag.read`."""
    from rosbags.rosbag1 import Reader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    imus, temperatures = [], []
    try:
        with Reader(path) as reader:
            for connection, _, data in reader.messages():
                if connection.msgtype not in ("sensor_msgs/msg/Imu", "sensor_msgs/msg/Temperature"):
                    continue
                m = store.deserialize_ros1(data, connection.msgtype)
                stamp = m.header.stamp.sec * 10**9 + m.header.stamp.nanosec
                if connection.msgtype.endswith("Imu"):
                    w, a = m.angular_velocity, m.linear_acceleration
                    imus.append((connection.topic, stamp, bits(w.x, w.y, w.z), bits(a.x, a.y, a.z)))
                else:
                    temperatures.append((connection.topic, stamp, bits(m.temperature), ""))
    except Exception as error:  # Whatever makes it refuse.
        return {"refused": f"{type(error).__name__}: {error}"}
    return imus, temperatures


def ours(dump, path, pipe, topic=None):
    """Lines of the dump: gyroscope, accelerometer, thermometer, and what was told."""
    command = [dump, "-" if pipe else path] + ([topic] if topic else [])
    with open(path, "rb") as file:
        done = subprocess.run(command, stdin=file if pipe else None, capture_output=True, text=True)
    lines = {"g": [], "a": [], "t": []}
    for line in done.stdout.splitlines():
        letter, stamp, values = line.split(" ", 2)
        lines[letter].append((int(stamp), values))
    return lines, done.returncode, done.stderr.strip()


def expected(messages, gyro, accel):
    """What the dump must print of (topic, stamp, rate, force) and (topic, stamp, celsius, "")."""
    imus, temperatures = messages
    return {
        "g": [(stamp, rate) for topic, stamp, rate, _ in imus if topic == gyro],
        "a": [(stamp, force) for topic, stamp, _, force in imus if topic == accel],
        "t": [(stamp, value) for _, stamp, value, _ in temperatures],
    }


def in_order(lines):
    """Other readers sort by time of recording, we keep the order of the file."""
    return {letter: sorted(rows) for letter, rows in lines.items()}


# Our own small writer: orders and omissions that no library makes.

def fields(rng, pairs):
    pairs = list(pairs)
    rng.shuffle(pairs)
    out = b""
    for name, value in pairs:
        field = name.encode() + b"=" + value
        out += struct.pack("<I", len(field)) + field
    return out


def record(rng, pairs, data):
    header = fields(rng, pairs)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def ros_time(ns):
    return struct.pack("<II", ns // 10**9, ns % 10**9)


def serialise(kind, ns, values, frame, seq):
    if kind == "text":
        text = values[0].encode()
        return struct.pack("<I", len(text)) + text
    head = struct.pack("<I", seq) + ros_time(ns) + struct.pack("<I", len(frame)) + frame.encode()
    values = [float.fromhex(v) for v in values]
    if kind == "temperature":
        return head + struct.pack("<2d", values[0], 0.0)
    body = [0.0] * 37
    body[13:16], body[25:28] = values[:3], values[3:]
    return head + struct.pack("<37d", *body)


def write_by_hand(rng, path, job, types, omit, lz4):
    """Writes a bag with shuffled header fields; `omit` names what is left out."""
    connections, numbers, order = {}, {}, rng.random()
    for kind, topic, caller, _, _ in job["messages"]:
        if (topic, caller) not in numbers:
            numbers[topic, caller] = len(numbers) * 3 + rng.randrange(3)
            connections[numbers[topic, caller]] = (kind, topic, caller)

    def connection(number):
        kind, topic, caller = connections[number]
        name, md5sum, definition = types[kind]
        described = [("topic", topic.encode()), ("type", name.encode()),
                     ("md5sum", md5sum.encode()), ("message_definition", definition.encode())]
        if caller:
            described += [("callerid", caller.encode()), ("latching", b"0")]
        data = fields(rng, described)
        head = [("op", b"\x07"), ("conn", struct.pack("<I", number)), ("topic", topic.encode())]
        return record(rng, head, data)

    def bag_header(index_pos, chunks):
        pairs = [("op", b"\x03"), ("index_pos", struct.pack("<Q", index_pos)),
                 ("conn_count", struct.pack("<I", len(connections))),
                 ("chunk_count", struct.pack("<I", chunks))]
        header = fields(rng, pairs)
        data = b" " * (4096 - len(header))
        return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data

    pack = {"none": lambda b: b, "bz2": bz2.compress, "lz4": lz4}[job["compression"]]
    out = bytearray(b"#ROSBAG V2.0\n" + bag_header(0, 0))
    infos, chunk, index, known = [], bytearray(), collections.defaultdict(list), set()

    def close():
        nonlocal chunk, index
        if not chunk:
            return
        start = len(out)
        data = pack(bytes(chunk))
        head = [("op", b"\x05"), ("compression", job["compression"].encode()),
                ("size", struct.pack("<I", len(chunk)))]
        out.extend(record(rng, head, data))
        if "index" not in omit:
            for number, entries in index.items():
                data = b"".join(ros_time(ns) + struct.pack("<I", at) for ns, at in entries)
                head = [("op", b"\x04"), ("ver", struct.pack("<I", 1)),
                        ("conn", struct.pack("<I", number)),
                        ("count", struct.pack("<I", len(entries)))]
                # rosbags takes the first index's order for granted in all of them.
                out.extend(record(random.Random(order), head, data))
        infos.append((start, {number: [ns for ns, _ in e] for number, e in index.items()}))
        chunk, index = bytearray(), collections.defaultdict(list)

    for seq, (kind, topic, caller, ns, values) in enumerate(job["messages"]):
        number = numbers[topic, caller]
        if number not in known:
            known.add(number)
            chunk += connection(number)
        index[number].append((ns, len(chunk)))
        payload = serialise(kind, ns, values, job["frame"], seq)
        head = [("op", b"\x02"), ("conn", struct.pack("<I", number)), ("time", ros_time(ns))]
        chunk += record(rng, head, payload)
        if len(chunk) >= job["chunk"]:
            close()
    close()
    index_pos = len(out)
    if "list" not in omit:
        for number in connections:
            out.extend(connection(number))
        if "infos" not in omit:
            for start, stamps in infos:
                times = [ns for of in stamps.values() for ns in of]
                data = b"".join(struct.pack("<II", n, len(of)) for n, of in stamps.items())
                head = [("op", b"\x06"), ("ver", struct.pack("<I", 1)),
                        ("chunk_pos", struct.pack("<Q", start)),
                        ("start_time", ros_time(min(times))), ("end_time", ros_time(max(times))),
                        ("count", struct.pack("<I", len(stamps)))]
                out.extend(record(rng, head, data))
    else:
        index_pos = 0
    header = bag_header(index_pos, len(infos))
    out[13:13 + len(header)] = header
    pathlib.Path(path).write_bytes(out)


def random_job(rng):
    """Messages of a random recording, and which topics `imu` is to take."""
    start = rng.randrange(10**9, 2 * 10**18)
    pair = rng.random() < 0.3
    if pair:
        gyro, accel = rng.choice([
            ("/camera/gyro/sample", "/camera/accel/sample"),
            ("/device_0/sensor_2/Gyro_0/imu/data", "/device_0/sensor_2/Accel_0/imu/data")])
    else:
        gyro = accel = rng.choice(["/imu", "imu", "/a/very/long/name" * 20 + "/imu", "/imu/data_raw"])
    messages, now = [], start
    callers = ["/driver", "/driver_again"] if rng.random() < 0.3 else [None]
    extras = rng.random() < 0.5
    for _ in range(rng.choice([1, 2, 10, 100, 400, 1500])):
        now += rng.randrange(1, 10**7)
        values = [rng.choice([rng.gauss(0, 1), 0.0, -0.0, 5e-324, rng.uniform(-1e300, 1e300)])
                  .hex() for _ in range(6)]
        topic = rng.choice([gyro, gyro, accel])
        messages.append(("imu", topic, rng.choice(callers), now, values))
        if extras and rng.random() < 0.3:
            text = "op=" * rng.randrange(1, 300)
            messages.append(("text", "/chatter", None, now + 1, [text]))
        if extras and rng.random() < 0.1:
            messages.append(("temperature", "/imu/temperature", None, now + 2, [rng.gauss(40, 1).hex()]))
        now += 3
    # Of a pair both must be there.
    for topic in dict.fromkeys([gyro, accel]):
        now += 1
        messages.append(("imu", topic, callers[0], now, [0.5.hex()] * 6))
    return {
        "messages": messages,
        "compression": rng.choice(["none", "bz2", "lz4"]),
        "chunk": rng.choice([1, 1000, 20_000, 768 * 1024]),
        "frame": rng.choice(["", "imu", "camera_imu_optical_frame"]),
    }, gyro, accel


def written(job):
    """The messages of a job in the form that readers give."""
    imus, temperatures = [], []
    for kind, topic, _, ns, values in job["messages"]:
        values = [float.fromhex(v) for v in values] if kind != "text" else []
        if kind == "imu":
            imus.append((topic, ns, bits(*values[:3]), bits(*values[3:])))
        elif kind == "temperature":
            temperatures.append((topic, ns, bits(*values), ""))
    return imus, temperatures


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("dump", type=pathlib.Path)
    parser.add_argument("--bags", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    dump, rng, rosbag = options.dump.resolve(), random.Random(options.seed), Rosbag()
    sys.path.append("/usr/lib/python3/dist-packages")
    types = json.loads(subprocess.run(
        [SYSTEM_PYTHON, "-c",
         "import json; from sensor_msgs.msg import Imu, Temperature; from std_msgs.msg import String\n"
         "print(json.dumps({k: (t._type, t._md5sum, t._full_text) for k, t in"
         " (('imu', Imu), ('temperature', Temperature), ('text', String))}))"],
        check=True, capture_output=True, text=True).stdout)

    def lz4(data):
        script = "import sys, roslz4; sys.stdout.buffer.write(roslz4.compress(sys.stdin.buffer.read()))"
        return subprocess.run([SYSTEM_PYTHON, "-c", script], input=data, check=True,
                              capture_output=True).stdout

    tally, failures = collections.Counter(), []

    def compare(name, kind, path, truth, gyro, accel, damaged):
        """One bag; `truth` is what was written, where that is known."""
        others = {"rosbags": with_rosbags(path), "rosbag": rosbag.read(path)}
        good = True
        for pipe in (False, True):
            lines, code, told = ours(dump, path, pipe)
            if code:
                good = False
                failures.append(f"{name}: imu refuses it: {told}")
                continue
            if bool(damaged) != ("warning: " in told):
                good = False
                failures.append(f"{name}: told {told!r}")
            for reader, read in others.items():
                if isinstance(read, dict):
                    tally[kind, f"refused by {reader}"] += not pipe
                    continue
                tally[kind, f"compared with {reader}"] += not pipe
                if in_order(lines) != in_order(expected(read, gyro, accel)):
                    good = False
                    failures.append(f"{name}: other samples than {reader}")
            if truth and lines != expected(truth, gyro, accel):
                good = False
                failures.append(f"{name}: other samples than were written")
        tally[kind, "good" if good else "BAD"] += 1
        tally["all", "samples"] += len(lines["g"]) + len(lines["a"])
        return lines, told

    with tempfile.TemporaryDirectory() as folder:
        folder = options.keep or pathlib.Path(folder)
        folder.mkdir(exist_ok=True)
        for number in range(options.count):
            job, gyro, accel = random_job(rng)
            path = folder / f"{number:03}.bag"
            omit = set()
            if number % 2:
                omit = set(rng.choice([(), (), ("infos",), ("index",), ("index", "list")]))
                write_by_hand(rng, path, job, types, omit, lz4)
                kind = f"own writer, {job['compression']}"
            else:
                refused = rosbag.ask(do="write", path=str(path), **job)
                assert refused is None, refused
                kind = f"rosbag, {job['compression']}"
            if omit:
                kind = f"own writer without {' and '.join(sorted(omit))}"
            compare(path.name, kind, path, written(job), gyro, accel, omit)
        for path in sorted(options.bags.glob("*.bag")) if options.bags else []:
            others = [with_rosbags(path), rosbag.read(path)]
            read = next((other for other in others if not isinstance(other, dict)), None)
            topic = read[0][0][0] if read else None
            lines, told = compare(path.name, path.name, path, None, topic, topic, read is None)
            print(f"{path.name}: {len(lines['g'])} and {len(lines['a'])} samples; {told or 'nothing told'}")
    for (kind, what), count in sorted(tally.items()):
        print(f"{kind}: {what}: {count}")
    for failure in failures[:40]:
        print(f"FAIL  {failure}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
