#!/usr/bin/env bash
# Peak memory of calibrating a bag of forty hours beside one of four.
#
# Usage: long_bag.sh IMU_BINARY [FOLDER]
#
# Writes bags of 4 h and 40 h at 200 Hz (1.1 and 11 GB) into FOLDER (default: a new temporary one),
# prints seconds and peak memory of `imu calibrate --json` for each, and deletes them.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 2; }
imu=$(realpath "$1")
work=$(mktemp -d "${2:-${TMPDIR:-/tmp}}/imu-figures.XXXXXX")
trap 'rm -rf "$work"' EXIT
for hours in 4 40; do
    "$imu" simulate mid --duration "${hours}h" -o "$work/a.bag" 2>/dev/null
    /usr/bin/time -o "$work/time" -f "%e %M" "$imu" calibrate "$work/a.bag" --json >"$work/json"
    awk -v hours="$hours" '{printf "%d h: %.1f s, peak %.1f MB\n", hours, $1, $2 / 1024}' "$work/time"
    rm "$work/a.bag"
done
