#!/usr/bin/env bash
# The plots of docs/noise.md: each term beside white noise of N = 1e-3 rad/s/√Hz in a gyroscope, simulated (2 h
# at 100 Hz, seed 1) and calibrated. The same program draws the same files again.
#
# Usage: draw.sh IMU_BINARY [FOLDER]     (the folder of this script, if none is given)
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 2; }
imu=$(realpath "$1")
folder=$(realpath "${2:-$(dirname "$0")}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# NAME: a plot of the scene whose gyroscope goes on with what stands on the standard input.
draw() {
    { printf 'rate_hz = 100\nduration = "2h"\nseed = 1\n[gyroscope]\nnoise_density = 1e-3\n'; cat; } >scene.toml
    "$imu" simulate scene.toml -o scene.csv 2>log || { cat log >&2; exit 1; }
    # The accelerometer, which is ideal, stays out; nothing else does.
    "$imu" calibrate scene.csv --columns t,gx,gy,gz,-,-,- --keep-all -o out >log 2>&1 || { cat log >&2; exit 1; }
    # Without the font, which is two thirds of the file.
    sed 's/@font-face {[^}]*}//' out/allan.svg >"$folder/$1.svg"
}

draw white </dev/null
draw random-walk <<<'random_walk = 5e-5'
draw gauss-markov <<<'gauss_markov = { standard_deviation = 2e-3, correlation_time_s = 30 }'
draw flicker <<<'flicker = { bias_instability = 5e-4, shortest_tau_s = 1, longest_tau_s = 1000 }'
draw quantisation <<<'quantisation = 2e-2'
draw increment-quantisation <<<'increment_quantisation = 2e-3'
draw rate-ramp <<<'rate_ramp = 1e-6'
draw warm-up <<<'temperature_coefficient = 2e-4
[temperature]
rise_k = 15
time_constant_s = 300'
draw sinusoid <<<'vibration = { amplitude = 2e-2, frequency_hz = 1 }'
draw band-vibration <<<'band_vibration = { standard_deviation = 5e-2, frequency_hz = 5, bandwidth_hz = 1 }'
