#!/usr/bin/env python3
"""Compares imu_core::preintegrate with GTSAM's PreintegratedImuMeasurements.

    cargo build --release -p imu-tests --example preintegration
    pip install gtsam numpy
    python3 tests/peers/check_gtsam.py target/release/examples/preintegration

One second of a body that turns by 2 rad/s and is shaken, at 200, 400 and 800 Hz. GTSAM takes one
measurement per step and holds it: it is given, of every step, the rate and the force (in axes at the
beginning of the step) that move the body as the midpoint rule does.

Neither can agree to more than a part in the number of steps. GTSAM (4.3.0, preintegration in the
tangent space, which its wheels have) moves the rotation vector by its derivative at the beginning of
the step, which is of first order; and as it holds the force in axes of that instant, a turn within
the step does not move the velocity in its Jacobians and covariance. So the difference must fall to a
half from one rate to the next; and what both come to with steps of no length (by Richardson's
extrapolation from the three rates) must agree to 1e-7: of rad, m/s and m for the delta, of the largest
element of a block of the Jacobian, of deviations for the covariance.

Prints one line a check; leaves with 1 if one failed.
"""

import json
import subprocess
import sys

import gtsam
import numpy as np

RATES = (200, 400, 800)
LIMIT_BOUND = 1e-7
BLOCKS = ("rotation_gyro", "velocity_gyro", "velocity_accel", "position_gyro", "position_accel")


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def right_jacobian(v):
    """J_r: Exp(v + dv) = Exp(v) Exp(J_r dv)."""
    angle, m = np.linalg.norm(v), skew(v)
    return (np.eye(3) - (1 - np.cos(angle)) / angle**2 * m
            + (angle - np.sin(angle)) / angle**3 * m @ m)


def ours(program, rate):
    run = subprocess.run([program, str(rate)], check=True, capture_output=True, text=True)
    printed = json.loads(run.stdout)
    delta = np.concatenate([printed[part] for part in ("rotation_vector", "velocity", "position")])
    jacobian = {name: np.array(printed["jacobian"][name]) for name in BLOCKS}
    c = {name: np.array(block) for name, block in printed["covariance"].items()}
    rv, rp, vp = c["rotation_velocity"], c["rotation_position"], c["velocity_position"]
    covariance = np.block([[c["rotation"], rv, rp], [rv.T, c["velocity"], vp],
                           [rp.T, vp.T, c["position"]]])
    return printed, delta, jacobian, covariance


def theirs(printed):
    params = gtsam.PreintegrationParams.MakeSharedU(0.0)
    params.setGyroscopeCovariance(printed["gyro_noise_density"] ** 2 * np.eye(3))
    params.setAccelerometerCovariance(printed["accel_noise_density"] ** 2 * np.eye(3))
    params.setIntegrationCovariance(np.zeros((3, 3)))
    pim = gtsam.PreintegratedImuMeasurements(params, gtsam.imuBias.ConstantBias())
    for rate, force in printed["steps"]:
        pim.integrateMeasurement(np.array(force), np.array(rate), printed["dt"])
    rotation = gtsam.Rot3.Logmap(pim.deltaRij())
    delta = np.concatenate([rotation, pim.deltaVij(), pim.deltaPij()])

    # Without gravity, from rest, a prediction is the delta, corrected to first order.
    def predicted(bias):
        state = pim.predict(gtsam.NavState(), gtsam.imuBias.ConstantBias(bias[3:], bias[:3]))
        turn = gtsam.Rot3.Logmap(pim.deltaRij().between(state.attitude()))
        return np.concatenate([turn, state.velocity(), state.position()])

    h = 1e-5
    columns = [(predicted(h * e) - predicted(-h * e)) / (2 * h) for e in np.eye(6)]
    dense = np.array(columns).T
    jacobian = {"rotation_gyro": dense[0:3, 0:3], "velocity_gyro": dense[3:6, 0:3],
                "velocity_accel": dense[3:6, 3:6], "position_gyro": dense[6:9, 0:3],
                "position_accel": dense[6:9, 3:6]}

    # Theirs is of (theta, p, v), theta being the rotation vector itself.
    to_ours = np.zeros((9, 9))
    to_ours[0:3, 0:3] = right_jacobian(rotation)
    to_ours[3:6, 6:9] = to_ours[6:9, 3:6] = np.eye(3)
    return delta, jacobian, to_ours @ pim.preintMeasCov() @ to_ours.T


def off(mine, other):
    """Differences of the delta, of each block of the Jacobian, and of the covariance."""
    (delta, jacobian, covariance), (delta_2, jacobian_2, covariance_2) = mine, other
    differences = {"delta": np.abs(delta - delta_2).max()}
    for name in BLOCKS:
        block = jacobian[name]
        differences[name] = np.abs(block - jacobian_2[name]).max() / np.abs(block).max()
    deviations = np.sqrt(np.diag(covariance))
    scaled = (covariance - covariance_2) / np.outer(deviations, deviations)
    return differences | {"covariance": np.abs(scaled).max()}


def limit(three):
    """From rates 1, 2, 4: without the errors of first and second order in the step."""
    a, b, c = three
    return (a - 6 * b + 8 * c) / 3


def limits(results):
    deltas, jacobians, covariances = zip(*results)
    jacobian = {name: limit([each[name] for each in jacobians]) for name in BLOCKS}
    return limit(deltas), jacobian, limit(covariances)


def main():
    failed = False

    def check(name, value, good):
        nonlocal failed
        failed |= not good
        print(f"{'ok  ' if good else 'FAIL'} {name}: {value}")

    mine, others = [], []
    for rate in RATES:
        printed, *result = ours(sys.argv[1], rate)
        mine.append(result)
        others.append(theirs(printed))
    falls = [off(a, b) for a, b in zip(mine, others)]
    for name, value in off(limits(mine), limits(others)).items():
        a, b, c = (fall[name] for fall in falls)
        halves = 1.9 < a / b < 2.1 and 1.9 < b / c < 2.1
        check(f"{name} at {RATES} Hz", f"{a:.1e}, {b:.1e}, {c:.1e} apart", halves)
        check(f"{name}, steps of no length", f"{value:.1e} apart", value < LIMIT_BOUND)
    sys.exit(failed)


if __name__ == "__main__":
    main()
