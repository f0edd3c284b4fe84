#!/usr/bin/env python3
"""Compare the exact batch estimator with Stable32's printed tables and with AllanTools.

    cargo build --release -p imu-tools --example allan_batch
    pip download allantools==2024.6 --no-deps --no-binary :all:   # its tests/ holds the tables
    python3 tests/peers/check_allan.py target/release/examples/allan_batch TABLES

TABLES is that tests/ folder, or one laid out like it: phasedat/PHASE.DAT with
phase_dat_KIND_octave.txt, ocxo/ocxo_frequency.txt with KIND_octave.txt and (where they are there)
stable32_KIND_alltau.txt, KIND being adev, oadev, hdev, ohdev. Without TABLES only random records are
compared. Needs python3 with numpy and allantools. Leaves with 1 if any bound is exceeded.

Bounds: 1e-4 against the tables, which print five digits; 1e-12 against AllanTools.

One exception. Stable32's octave tables of the OCXO were made from frequencies around 1.0, noise
7e-11, added up in plain double precision, and carry its rounding: OADEV at 1 s differs from ADEV
at 1 s, which are the same thing. So they are compared twice: with sums rounded in the same way (1e-4,
which shows where the difference comes from), and as they are (2e-3, the bound of AllanTools' own
tests). The tables of all tau were made from the same record without the offset, and are compared at
1e-4 like the others.
"""

import os
import subprocess
import sys

import allantools
import numpy as np

KINDS = ("adev", "oadev", "hdev", "ohdev")
TABLE_BOUND = 1e-4
OFFSET_BOUND = 2e-3
PEER_BOUND = 1e-12


def ours(program, values, blocks):
    """{kind: {m: (deviation)}} as printed by the example."""
    text = "\n".join(repr(float(v)) for v in values)
    command = [program, "-", *(str(m) for m in blocks)]
    lines = subprocess.run(command, input=text, text=True, check=True, capture_output=True).stdout
    header, *rows = (line.split(",") for line in lines.split())
    result = {kind: {} for kind in KINDS}
    for row in rows:
        for kind, field in zip(header[1:], row[1:]):
            if field:
                result[kind][int(row[0])] = float(field)
    return result


def table(path):
    """{m: deviation} from a Stable32 listing: AF, tau, terms, alpha, low, deviation, high."""
    rows = np.loadtxt(path, comments="#", ndmin=2)
    return {int(row[0]): row[5] for row in rows}


def report(source, name, kind, errors, bound):
    """Print one line; whether the bound holds."""
    worst = max(errors)
    verdict = "" if worst <= bound else f"  EXCEEDS {bound:.0e}"
    print(f"{source:10} {name:24} {kind:6} {len(errors):4} values, worst {worst:.1e}{verdict}")
    return worst <= bound


def against_tables(program, name, values, pattern, bound):
    good = []
    for kind in KINDS:
        printed = table(pattern.replace("KIND", kind))
        got = ours(program, values, printed)[kind]
        errors = [abs(got[m] / want - 1.0) for m, want in printed.items()]
        good.append(report("Stable32", name, kind, errors, bound))
    return good


def with_plain_sums(values, kind, m):
    """The deviation from sums of `values`, offset and all, rounded at every addition."""
    order, norm = (3, 6.0) if kind.endswith("hdev") else (2, 2.0)
    if kind.startswith("o"):
        phase = np.concatenate([[0.0], np.cumsum(values)])
        x = [phase[k * m : len(phase) - (order - k) * m] for k in range(order + 1)]
        steps = x[3] - 3 * x[2] + 3 * x[1] - x[0] if order == 3 else x[2] - 2 * x[1] + x[0]
    else:
        blocks = values[: len(values) // m * m].reshape(-1, m)
        steps = np.diff(np.cumsum(blocks, axis=1)[:, -1] / m, order - 1) * m
    return np.sqrt(np.mean(steps**2) / norm) / m


def against_rounded_tables(values, pattern):
    good = []
    for kind in KINDS:
        printed = table(pattern.replace("KIND", kind))
        errors = [abs(with_plain_sums(values, kind, m) / d - 1.0) for m, d in printed.items()]
        good.append(report("Stable32", "OCXO, rounded alike", kind, errors, TABLE_BOUND))
    return good


def against_allantools(program, name, values):
    blocks = sorted({2**k for k in range(40)} | {3, 10, 100, 777, 5000})
    blocks = [m for m in blocks if 3 * m <= len(values)]
    got = ours(program, values, blocks)
    good = []
    for kind in KINDS:
        # Readings of a single difference are left out by AllanTools.
        taus, deviations, _, _ = getattr(allantools, kind)(
            values, rate=1.0, data_type="freq", taus=blocks
        )
        errors = [abs(got[kind][round(tau)] / d - 1.0) for tau, d in zip(taus, deviations)]
        good.append(report("AllanTools", name, kind, errors, PEER_BOUND))
    return good


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    program = sys.argv[1]
    good = []
    rng = np.random.default_rng(14)
    white = rng.standard_normal
    records = {
        "white 100000": white(100_000),
        "white + walk 300001": white(300_001) + 1e-2 * np.cumsum(white(300_001)),
        "9.81 + 1e-3 white 50000": 9.81 + 1e-3 * white(50_000),
    }
    if len(sys.argv) == 3:
        folder = sys.argv[2]
        phase = np.loadtxt(os.path.join(folder, "phasedat", "PHASE.DAT"), comments="#")
        hertz = np.loadtxt(os.path.join(folder, "ocxo", "ocxo_frequency.txt"), comments="#")
        records["PHASE.DAT"] = np.diff(phase)
        records["OCXO"] = hertz / 1e7 - 1.0
        octave = os.path.join(folder, "phasedat", "phase_dat_KIND_octave.txt")
        good += against_tables(program, "PHASE.DAT", records["PHASE.DAT"], octave, TABLE_BOUND)
        every = os.path.join(folder, "ocxo", "stable32_KIND_alltau.txt")
        if os.path.exists(every.replace("KIND", "adev")):
            good += against_tables(program, "OCXO, all tau", records["OCXO"], every, TABLE_BOUND)
        octave = os.path.join(folder, "ocxo", "KIND_octave.txt")
        good += against_rounded_tables(hertz / 1e7, octave)
        good += against_tables(program, "OCXO, octaves", records["OCXO"], octave, OFFSET_BOUND)
    for name, values in records.items():
        good += against_allantools(program, name, values)
    print("all within bounds" if all(good) else "bounds exceeded")
    sys.exit(not all(good))


if __name__ == "__main__":
    main()
