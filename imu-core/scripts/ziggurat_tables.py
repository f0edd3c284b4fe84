#!/usr/bin/env python3
"""Writes src/noise/ziggurat_tables.rs, the layers of the normal distribution's ziggurat.

Method: Marsaglia & Tsang (2000), "The Ziggurat Method for Generating Random Variables",
Journal of Statistical Software 5(8): n layers of equal area V under f(x) = exp(-x²/2), the lowest
one being the rectangle [0, R] x [0, f(R)] with the tail beyond R.  R is found by bisection on
"the top layer ends at f = 1", in decimal arithmetic of 50 digits.  Needs only Python.

    python3 imu-core/scripts/ziggurat_tables.py > imu-core/src/noise/ziggurat_tables.rs
"""

from decimal import Decimal as D, getcontext
import struct

getcontext().prec = 50


def f(x):
    return (-x * x / 2).exp()


def tail(r):
    """Integral of f from r to infinity, by the continued fraction of Mills' ratio."""
    t = D(0)
    for k in range(400, 0, -1):
        t = k / (r + t)
    return f(r) / (r + t)


def layers(n, r):
    """x[0] (the pseudo-edge V/f(R)), x[1] = R, ..., x[n-1]; f at the top; the common area V."""
    v = r * f(r) + tail(r)
    x = [v / f(r), r]
    height = f(r)
    for _ in range(n - 2):
        height += v / x[-1]
        if height >= 1:
            return None, height, v
        x.append((-2 * height.ln()).sqrt())
    return x, height + v / x[-1], v


def solve(n):
    low, high = D(3), D(4)
    for _ in range(150):
        r = (low + high) / 2
        _, top, _ = layers(n, r)
        # A smaller R makes larger layers, which reach above 1.
        low, high = (r, high) if top > 1 else (low, r)
    # `high` is the side whose top layer ends just below 1: all its edges exist.
    x, _, v = layers(n, high)
    return x + [D(0)], v


def as_f32(x):
    """The shortest decimal that names the f32 nearest to x."""
    y = struct.unpack("f", struct.pack("f", float(x)))[0]
    for digits in range(1, 12):
        s = f"{y:.{digits}e}"
        if struct.unpack("f", struct.pack("f", float(s)))[0] == y:
            return s
    return repr(y)


def rows(items, width=4):
    return ["    " + ", ".join(items[i : i + width]) + "," for i in range(0, len(items), width)]


def emit(n, bits, real, word):
    x, v = solve(n)
    name = real.upper()
    show = (lambda y: repr(float(y))) if real == "f64" else as_f32
    scale = D(2) ** bits

    def number(y):
        s = show(y)
        return s if any(c in s for c in ".e") else s + ".0"

    out = [
        f"/// Where the tail begins, {n} layers.",
        f"pub(super) const R_{name}: {real} = {number(x[1])};",
        "",
        f"/// {n} layers, lowest first: (integers below this are under the curve, step of one integer).",
        f"pub(super) static LAYERS_{name}: [({word}, {real}); {n}] = [",
    ]
    inner = [int(scale * x[i + 1] / x[i]) for i in range(n)]
    out += rows([f"({inner[i]}, {number(x[i] / scale)})" for i in range(n)])
    out += [
        "];",
        "",
        "/// f at the lower edge of each layer, and 1 at last (0 stands for the lowest layer's).",
        f"pub(super) static HEIGHTS_{name}: [{real}; {n + 1}] = [",
    ]
    out += rows([number(D(0) if i == 0 else f(x[i])) for i in range(n + 1)])
    out += ["];"]
    return out


print("//! Written by scripts/ziggurat_tables.py: the layers of the normal ziggurat. Do not edit.")
print("#![cfg_attr(rustfmt, rustfmt_skip)]")
print("#![allow(clippy::excessive_precision)]")
print()
print("\n".join(emit(128, 24, "f32", "u32")))
print()
print("\n".join(emit(256, 53, "f64", "u64")))
