#!/usr/bin/env bash
# Counts the instructions that the stereo methods execute for one frame on a Cortex-M4F, in QEMU.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: firmware/bare.sh [-d DISPARITIES] [LEFT.pgm RIGHT.pgm]

Runs one frame through lite, full and block on an emulated Cortex-M4F and prints the executed
instructions, counted exactly, and a checksum of each answer.

  -d DISPARITIES       that lite and full search (default 48); block searches 16, 48 and 64
  LEFT.pgm RIGHT.pgm   grey pictures of 8 bits (PGM, binary), up to 320 px wide;
                       without them a built-in picture is used
TEXT
}

fail() {
    echo "bare.sh: $1" >&2
    exit 1
}

disparities=48
while getopts d:h option; do
    case $option in
        d) disparities=$OPTARG ;;
        h) usage; exit ;;
        *) usage >&2; exit 2 ;;
    esac
done
shift $((OPTIND - 1))
[[ $disparities =~ ^[0-9]+$ ]] || fail "-d takes a number, not '$disparities'"
[[ $# == 0 || $# == 2 ]] || { usage >&2; exit 2; }

target=thumbv7em-none-eabihf
command -v cargo >/dev/null || fail "cargo is missing: see https://rustup.rs"
command -v qemu-system-arm >/dev/null ||
    fail "qemu-system-arm is missing: install it (Debian, Ubuntu: sudo apt-get install qemu-system-arm)"
[[ -n $(find "$(rustc --print sysroot)/lib/rustlib/$target/lib" -name 'libcore-*.rlib' 2>/dev/null) ]] ||
    fail "Rust's target $target is missing: rustup target add $target"

# QEMU's arguments allow neither spaces nor commas in paths, so the pictures get plain names.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
semihosting=enable=on,target=native,arg=bare,arg=$disparities
if [[ $# == 2 ]]; then
    cp -- "$1" "$work/left.pgm"
    cp -- "$2" "$work/right.pgm"
    semihosting+=,arg=left.pgm,arg=right.pgm
fi

# Cargo itself tells where the program lies; its messages go to the screen.
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
messages=$(cargo build --quiet -p haarline-firmware --bin bare --profile firmware --target "$target" \
    --message-format json-render-diagnostics)
program=$(sed -n 's/.*"executable":"\([^"]*\/bare\)".*/\1/p' <<<"$messages")
[[ -f $program ]] || fail "cargo has built no program"

# An instruction is 64 ns of virtual time: src/bin/bare/clock.rs counts on it.
cp -- "$program" "$work/bare"
cd "$work"
qemu-system-arm -machine mps2-an386 -nographic -monitor none -serial none \
    -icount shift=6,sleep=off -semihosting-config "$semihosting" -kernel bare
