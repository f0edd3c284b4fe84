#!/usr/bin/env bash
# How long `imu demo` takes: three noise levels of four hours at 200 Hz (wanted: at most 30 s).
#
# Usage: demo.sh IMU_BINARY [RUNS]
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,4s/^# \{0,1\}//p' "$0"; exit 2; }
imu=$(realpath "$1")
runs=${2:-3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
for _ in $(seq "$runs"); do
    /usr/bin/time -a -o "$work/time" -f "%e %M" "$imu" demo >"$work/out" 2>"$work/err"
done
sort -g "$work/time" | awk '{s[NR] = $1; if ($2 > most) most = $2}
    END {printf "demo: %.1f s (median of %d), peak %.1f MB\n", s[int((NR + 1) / 2)], NR, most / 1024}'
