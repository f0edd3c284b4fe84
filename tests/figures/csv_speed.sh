#!/usr/bin/env bash
# How fast and in how much memory a four-hour CSV is calibrated, plain and compressed.
#
# Usage: csv_speed.sh IMU_BINARY [RUNS] [FOLDER]
#
# Writes a CSV of 4 h at 200 Hz (402 MB) into FOLDER (default: a new temporary one), then prints, as
# medians of RUNS (default 5) interleaved runs with the file in memory, seconds, megabytes of text a
# second (wanted: at least 150 for the plain file) and peak memory of
#   - `cat CSV > /dev/null`
#   - `imu calibrate CSV --json`
#   - the same of CSV.gz and CSV.zst, where `gzip` and `zstd` are installed
# Needs GNU time (/usr/bin/time) and 0.9 GB of disk. Deletes what it wrote.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,13s/^# \{0,1\}//p' "$0"; exit 2; }
imu=$(realpath "$1")
runs=${2:-5}
work=$(mktemp -d "${3:-${TMPDIR:-/tmp}}/imu-figures.XXXXXX")
trap 'rm -rf "$work"' EXIT
csv=$work/still.csv

# Wall and processor seconds and peak kilobytes of a command, appended to a file.
timed() { local to=$1; shift; /usr/bin/time -a -o "$work/$to" -f "%e %U %S %M" "$@" 2>"$work/err"; }

"$imu" simulate mid --seed 1 -o "$csv" 2>/dev/null
bytes=$(stat -c %s "$csv")
files=("$csv")
if command -v gzip >/dev/null; then gzip -1 -k "$csv"; files+=("$csv.gz"); fi
if command -v zstd >/dev/null; then zstd -q -3 "$csv"; files+=("$csv.zst"); fi
echo "CSV: $bytes bytes, 4 h at 200 Hz; $runs runs, medians; load $(cut -d' ' -f1 /proc/loadavg) on $(nproc) cores"
for _ in $(seq "$runs"); do
    timed cat sh -c 'cat "$1" > /dev/null' - "$csv"
    for file in "${files[@]}"; do
        timed "calibrate ${file##*.}" sh -c '"$1" calibrate "$2" --json > /dev/null' - "$imu" "$file"
    done
done
for what in cat "calibrate csv" "calibrate gz" "calibrate zst"; do
    [ -e "$work/$what" ] || continue
    sort -g "$work/$what" | awk -v what="$what" -v bytes="$bytes" '
        { wall[NR] = $1; processor[NR] = $2 + $3; if ($4 > most) most = $4 }
        END { m = int((NR + 1) / 2)
              printf "%-14s %6.2f s, %5.0f MB/s; processor %6.2f s, %5.0f MB/s; peak %.1f MB\n",
                  what, wall[m], bytes / 1e6 / (wall[m] + 1e-9), processor[m],
                  bytes / 1e6 / (processor[m] + 1e-9), most / 1024 }'
done
