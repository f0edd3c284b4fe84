#!/usr/bin/env bash
# How fast and in how much memory a four-hour bag or MCAP file is calibrated and simulated.
#
# Usage: bag_speed.sh IMU_BINARY [RUNS] [FOLDER] [bag|mcap]
#
# Writes a recording of 4 h at 200 Hz (about 1 GB) into FOLDER (default: a new temporary one), then
# prints, as medians of RUNS (default 5) interleaved runs:
#   - `imu calibrate FILE --json` beside `cat FILE > /dev/null`, both with the file in memory,
#     and its peak memory (wanted: at most 2 times, at most 64 MB)
#   - `imu simulate` beside writing as many bytes with `cat` (wanted: at most 3 s more)
#   - peak memory for ten times the length, through a pipe (wanted: the same)
# Needs GNU time (/usr/bin/time) and 2.2 GB of disk. Deletes what it wrote.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,13s/^# \{0,1\}//p' "$0"; exit 2; }
imu=$(realpath "$1")
runs=${2:-5}
work=$(mktemp -d "${3:-${TMPDIR:-/tmp}}/imu-figures.XXXXXX")
trap 'rm -rf "$work"' EXIT
ending=${4:-bag}
bag=$work/still.$ending

# Wall seconds and peak kilobytes of a command, appended to a file.
timed() { local to=$1; shift; /usr/bin/time -a -o "$work/$to" -f "%e %M" "$@" 2>"$work/err"; }
median() { sort -g "$work/$1" | awk -v column="$2" '{v[NR] = $column} END {print v[int((NR + 1) / 2)]}'; }
peak() { awk '$2 > most {most = $2} END {printf "%.1f MB", most / 1024}' "$work/$1"; }

"$imu" simulate mid --seed 1 -o "$bag" 2>/dev/null
cat "$bag" >/dev/null
echo "$ending: $(stat -c %s "$bag") bytes, 4 h at 200 Hz; $runs runs, medians; load $(cut -d' ' -f1 /proc/loadavg) on $(nproc) cores"
for _ in $(seq "$runs"); do
    timed cat sh -c 'cat "$1" > /dev/null' - "$bag"
    timed calibrate sh -c '"$1" calibrate "$2" --json > /dev/null' - "$imu" "$bag"
done
awk -v cat="$(median cat 1)" -v us="$(median calibrate 1)" -v peak="$(peak calibrate)" 'BEGIN {
    printf "calibrate: %.2f s, cat: %.2f s, ratio %.2f (wanted: at most 2); peak %s (at most 64)\n", us, cat, us / cat, peak }'

for _ in $(seq "$runs"); do
    rm -f "$work/copy.$ending" "$work/again.$ending"
    sync "$work"
    timed write sh -c 'cat "$1" > "$2"' - "$bag" "$work/copy.$ending"
    rm -f "$work/copy.$ending"
    sync "$work"
    timed simulate "$imu" simulate mid --seed 1 -o "$work/again.$ending"
done
cmp "$bag" "$work/again.$ending"
rm -f "$work/again.$ending"
awk -v write="$(median write 1)" -v us="$(median simulate 1)" -v peak="$(peak simulate)" 'BEGIN {
    printf "simulate: %.2f s, writing as many bytes: %.2f s, beyond it %.2f s (wanted: at most 3); peak %s\n", us, write, us - write, peak }'

# A sample is the same to calibrate whether it comes from a bag or a table: memory is what counts.
for hours in 4 40; do
    "$imu" simulate mid --duration "${hours}h" -o - 2>/dev/null \
        | timed "pipe$hours" "$imu" calibrate - --json >"$work/json"
    echo "$hours h through a pipe: $(median "pipe$hours" 1) s, peak $(peak "pipe$hours")"
done
