#!/usr/bin/env bash
# The board's unmodified release program on an emulated STM32H743: the self test, a scene and a recording
# through the camera port, whose row packets must be the host's maps byte for byte, and camera faults, each
# counted, with the next good frame as in a clean run.
#
#   firmware/emulate.sh [DATA]    DATA: the folder with qvga/ and stereoboard/ (default: $HAARLINE_DATA
#                                 or ../shared/data beside the project)
#
# ARM_TOOLCHAIN names a toolchain that has the target thumbv7em-none-eabihf, if the usual one has not.
# The emulator (a package of its own) takes some minutes to build the first time.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
data=${1:-${HAARLINE_DATA:-$root/../shared/data}}
target_dir=${CARGO_TARGET_DIR:-$root/target}
arm_dir=${ARM_TARGET_DIR:-$target_dir/arm}
target=thumbv7em-none-eabihf
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

build() { # build PROGRAM [NAME=VALUE...]: the release program, for one rig
  local program=$1
  shift
  env ${ARM_TOOLCHAIN:+RUSTUP_TOOLCHAIN=$ARM_TOOLCHAIN} CARGO_TARGET_DIR="$arm_dir" "$@" \
    cargo build --quiet -p haarline-firmware --release --target $target --bin "$program"
  cp "$arm_dir/$target/release/$program" "$out/$program.elf"
}
emulate() { "$target_dir/release/haarline-emulator" "$@" | grep -v '^told'; }
same() { # same CHIP HOST FRAMES...: those frames of the chip are those of the host
  local chip=$1 host=$2 frame
  shift 2
  for frame in "$@"; do
    cmp "$chip/$(printf %06d "${frame%%=*}").pfm" "$host/${frame##*=}.pfm"
  done
}
counter() { # counter NAME: of the last packet
  python3 - "$out/chip/frames.csv" "$1" <<'PY'
import csv, sys
print(list(csv.DictReader(open(sys.argv[1])))[-1][sys.argv[2]])
PY
}
says() { grep -q "$1" "$out/log" || { echo "the log does not say: $1"; cat "$out/log"; exit 1; }; }

CARGO_TARGET_DIR=$target_dir cargo build --quiet --release -p haarline-sim
(cd firmware/emulator && CARGO_TARGET_DIR=$target_dir cargo build --quiet --release --ignore-rust-version)
haarline=$target_dir/release/haarline

echo "== self test"
build selftest
emulate "$out/selftest.elf" --limit 400 --log "$out/log"
cat "$out/log"
says 'self test passed'

echo "== a scene, 320x240"
build firmware
"$haarline" record "$data/qvga/tsukuba/left.png" "$data/qvga/tsukuba/right.png" --wiring pixel -o "$out/scene.raw"
"$haarline" play "$out/scene.raw" --raw 320x240 --wiring pixel --num-disparities 64 -o "$out/host"
scene() { # scene FRAMES [OPTION...]
  local frames=$1
  shift
  rm -rf "$out/chip"
  emulate "$out/firmware.elf" --raw "$out/scene.raw" --size 320x240 --frames "$frames" --rows "$out/rows" --log "$out/log" "$@"
  "$haarline" receive "$out/rows" -o "$out/chip"
}
scene 3
cat "$out/log"
same "$out/chip" "$out/host" 0=000000 1=000000 2=000000
for name in dropped_rows dropped_frames overruns short long stalled; do
  [ "$(counter $name)" = 0 ] || { echo "a clean run counts $name $(counter $name)"; exit 1; }
done
cp "$out/rows" "$out/rows.first"
scene 3 >/dev/null
cmp "$out/rows.first" "$out/rows"
echo "twice the same bytes"

fault() { # fault KIND COUNTER: in frame 1 of 4
  scene 4 --fault "$1@1"
  echo "$1: $2 $(counter "$2")"
  [ "$(counter "$2")" -ge 1 ]
  # Frame 1 may be anything; those around it are good.
  same "$out/chip" "$out/host" 0=000000 2=000000 3=000000
}
echo "== faults of the camera"
fault short short
fault long long
fault overrun overruns
# What is counted here is the pause after it, as long as a trigger that came too early: the silence within the
# frame itself goes uncounted on the emulated chip, and its rows are whole all the same.
fault stall stalled
fault garbage dropped_rows
scene 2 --fault silent
says 'no answer from sensor 1'
same "$out/chip" "$out/host" 0=000000 1=000000

echo "== a recording, 128x96"
build firmware HAARLINE_SIZE=128x96 HAARLINE_NUM_DISPARITIES=32
take=$data/stereoboard/db1_forward_take01
"$haarline" record --recording "$take" --layout side-by-side --layout-first right --frames 0..4 --wiring pixel -o "$out/take.raw"
"$haarline" play "$out/take.raw" --raw 128x96 --wiring pixel --num-disparities 32 -o "$out/take"
rm -rf "$out/chip"
emulate "$out/firmware.elf" --raw "$out/take.raw" --size 128x96 --frames 4 --rows "$out/rows" --log "$out/log"
"$haarline" receive "$out/rows" -o "$out/chip"
same "$out/chip" "$out/take" 0=000000 1=000001 2=000002 3=000003
echo "all as it should be"
