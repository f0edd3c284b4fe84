#!/usr/bin/env python3
"""Compares arrays that NumPy writes with what `imu` reads of them.

Usage: check_numpy.py IMU_BINARY

Simulates a minute as a CSV, saves its numbers with NumPy (pip install numpy) as .npy and .npz in
every order, type and shape that is read, converts each with `imu convert` to a CSV again, and
compares: stamps to the nanosecond, values to the bit (of single precision where that was saved).

Prints one line a check; leaves with 1 if one failed.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np


def table(path):
    """Stamps and six values a row."""
    stamps = np.loadtxt(path, delimiter=",", skiprows=1, usecols=0, dtype=np.int64)
    values = np.loadtxt(path, delimiter=",", skiprows=1, usecols=range(1, 7))
    return stamps, values


def arrays(folder, stamps, values):
    """Saves all forms; yields each with its flags and the values that it holds."""
    t, seven = stamps / 1e9, np.column_stack([stamps / 1e9, values])
    single = values.astype(np.float32)

    def save(name, array, flags=(), of=values):
        path = folder / f"{name}.npy"
        np.save(path, array)
        return path, flags, of

    ns = ("--time-unit", "ns")
    yield save("c", seven)
    yield save("fortran", np.asfortranarray(seven))
    yield save("transposed", np.ascontiguousarray(seven.T))
    yield save("big_endian", seven.astype(">f8"))
    yield save("order", seven[:, [4, 5, 6, 1, 2, 3, 0]], ("--columns", "ax,ay,az,gx,gy,gz,t"))
    yield save("integers", np.column_stack([stamps - stamps[0], np.round(values)]).astype(np.int64),
               ns, np.round(values))
    fields = [("stamp", "<i8"), ("gyro", "<f4", (3,)), ("accel", ">f8", (3,)), ("label", "S3")]
    structure = np.zeros(len(stamps), dtype=fields)
    structure["stamp"], structure["gyro"] = stamps, single[:, :3]
    structure["accel"] = values[:, 3:]
    mixed = np.column_stack([single[:, :3].astype(float), values[:, 3:]])
    yield save("structure", structure, ns, mixed)
    dated = np.zeros(len(stamps), dtype=[("time", "<M8[ns]"), ("gyro", "<f8", (3,))])
    dated["time"], dated["gyro"] = stamps.astype("<M8[ns]"), values[:, :3]
    yield save("datetime", dated, (), values[:, :3])
    for name, write in (("stored", np.savez), ("deflated", np.savez_compressed)):
        path = folder / f"{name}.npz"
        write(path, t=stamps, gyro=values[:, :3], accel=np.asfortranarray(values[:, 3:]))
        yield path, ns, values
        path = folder / f"one_{name}.npz"
        write(path, seven)
        yield path, (), values
        path = folder / f"single_{name}.npz"
        write(path, time=t, w=single[:, :3], a=single[:, 3:], label=np.array(["x", "y"]))
        yield path, (), single.astype(float)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    imu, failed = pathlib.Path(sys.argv[1]).resolve(), 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        source, back = folder / "source.csv", folder / "back.csv"
        subprocess.run([imu, "simulate", "mid", "--duration", "60s", "-o", source], check=True,
                       stderr=subprocess.DEVNULL)
        stamps, values = table(source)
        for path, flags, expected in arrays(folder, stamps, values):
            command = [imu, "convert", "--force", path, back, *flags]
            said = subprocess.run(command, capture_output=True, text=True)
            if said.returncode:
                same, why = False, said.stderr.strip()
            else:
                columns = range(1, 1 + expected.shape[1])
                read = np.loadtxt(back, delimiter=",", skiprows=1, usecols=columns)
                t = np.loadtxt(back, delimiter=",", skiprows=1, usecols=0, dtype=np.int64)
                # Seconds in a double are exact to 240 ns in this century.
                same = np.array_equal(read, expected) and np.abs(
                    t - t[0] - (stamps - stamps[0])).max() <= 240
                why = "" if same else "other numbers"
            print(f"{'ok  ' if same else 'FAIL'} {path.name} {why}")
            failed += not same
            back.unlink(missing_ok=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
