#!/usr/bin/env python3
"""Shows on an emulated STM32H743 that the phase pins of the feature `measure` tell what the program does, at every edge of a
frame; that what it counts can be fetched as a probe fetches it; that `profile` works and sleeps as long as it says; and that
`haarline power measure` makes of a meter's recording of all that what went into it.

usage: firmware/checks/power.py [DATA]

DATA is the folder with stereoboard (default: $HAARLINE_DATA or ../shared/data beside the project). ARM_TOOLCHAIN names a
toolchain with the target thumbv7em-none-eabihf, if the usual one has it not.
"""

import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verdicts import Failure, expect, run_all

ROOT = Path(__file__).resolve().parents[2]
TARGET = "thumbv7em-none-eabihf"
TARGET_DIR = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
ARM_TOOLCHAIN = os.environ.get("ARM_TOOLCHAIN")
ARM_DIR = TARGET_DIR / "arm" if ARM_TOOLCHAIN else TARGET_DIR
HAARLINE, EMULATOR = TARGET_DIR / "release" / "haarline", TARGET_DIR / "release" / "haarline-emulator"
TAKE = "db1_forward_take01"
WIDTH, HEIGHT, RATE, FRAMES, EXPOSURE = 128, 96, 10, 13, 40

IDLE, CAPTURE, COMPUTE, SEND = (0, 0), (1, 0), (1, 1), (0, 1)
NAMES = {IDLE: "idle", CAPTURE: "capture", COMPUTE: "compute", SEND: "send"}
# What is told for a moment, ns at most, between two phases that differ in both pins.
BETWEEN = {(IDLE, COMPUTE): SEND, (COMPUTE, IDLE): SEND, (CAPTURE, SEND): COMPUTE, (SEND, CAPTURE): COMPUTE}
LONGEST_BETWEEN = 5000
# What a meter shall see, mA at 3.3 V.
CURRENTS = {IDLE: 12.0, CAPTURE: 31.0, COMPUTE: 97.0, SEND: 44.0}
METHODS = ["full", "lite", "wavelet-block", "contour", "envelope", "block", "sgm"]
# Of the counters and of the frames that `profile` counts, words.
MEASURED, COUNTED = 30, len(METHODS) + 1
# So slow `profile` runs here that its 28 s are done in less than a minute; what it does when is the same.
PROFILE_MHZ = 24
US = 1000


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Failure(f"{Path(command[0]).name}, exit status {done.returncode}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def cargo(*arguments, folder=ROOT, target_dir=TARGET_DIR, **variables):
    run("cargo", *arguments, cwd=folder, env={**os.environ, "CARGO_TARGET_DIR": str(target_dir), **variables})


def build(program, **variables):
    toolchain = {"RUSTUP_TOOLCHAIN": ARM_TOOLCHAIN} if ARM_TOOLCHAIN else {}
    cargo("build", "--quiet", "-p", "haarline-firmware", "--release", "--target", TARGET, "--features", "measure", "--bin", program,
          target_dir=ARM_DIR, **toolchain, **variables)
    return ARM_DIR / TARGET / "release" / program


class Phases:
    """What the pins told: spans of one phase, from the start to the run's end, ns; without those between two others, which must
    be there wherever these differ in both pins, and nowhere else."""

    def __init__(self, path, end):
        with open(path, newline="") as file:
            edges = [(int(edge["ns"]), (int(edge["low"]), int(edge["high"]))) for edge in csv.DictReader(file)]
        starts = [(0, IDLE), *edges]
        ends = [at for at, _ in edges] + [end]
        told = [(at, until, phase) for (at, phase), until in zip(starts, ends)]
        for (_, _, one), (at, _, other) in zip(told, told[1:]):
            if (one[0] != other[0]) + (one[1] != other[1]) != 1:
                raise Failure(f"at {at} ns from {NAMES[one]} to {NAMES[other]}")
        self.edges, self.between, self.spans = len(edges), 0, told[:1]
        for (_, _, before), (at, until, phase), (_, _, after) in zip(told, told[1:], told[2:] + [(end, end, None)]):
            if BETWEEN.get((before, after)) == phase and until - at <= LONGEST_BETWEEN:
                self.between += 1
                begin, _, last = self.spans[-1]
                self.spans[-1] = (begin, until, last)
            else:
                self.spans.append((at, until, phase))

    def at(self, time):
        return next(phase for begin, end, phase in self.spans if begin <= time < end)

    def time(self, phase, begin=0, end=float("inf")):
        return sum(max(0, min(until, end) - max(at, begin)) for at, until, of in self.spans if of == phase)

    def recording(self, path, rate):
        """As a PPK2 would export it, and the energy of each phase, J: of each sample that of the phase at its middle."""
        step, joules, seconds = 1e9 / rate, dict.fromkeys(NAMES, 0.0), dict.fromkeys(NAMES, 0.0)
        with open(path, "w") as file:
            file.write("Timestamp(ms),Current(uA),D0,D1\n")
            nth = 0
            for begin, end, phase in self.spans:
                while (nth + 0.5) * step < end:
                    file.write(f"{nth * step / 1e6:.3f},{1000 * CURRENTS[phase]:.1f},{phase[0]},{phase[1]}\n")
                    nth += 1
                joules[phase] += CURRENTS[phase] / 1000 * 3.3 * (end - begin) / 1e9
                seconds[phase] += (end - begin) / 1e9
        return joules


class Firmware:
    """A run of the product while its current is measured."""

    def __init__(self, elf, dump, folder, mhz):
        folder.mkdir()
        self.folder, self.phases_file = folder, folder / "phases.csv"
        self.told = run(EMULATOR, elf, "--mhz", mhz, "--raw", dump, "--size", f"{WIDTH}x{HEIGHT}", "--frames", FRAMES, "--phases", self.phases_file,
                        "--rows", folder / "rows", "--read", f"HAARLINE_MEASURED:{MEASURED}", "--tail", 60)
        end = 1_000_000 * int(re.search(r"virtual time (\d+) ms", self.told)[1])
        self.phases = Phases(self.phases_file, end)
        milliseconds = re.search(r"frames' first lines at (.*)", self.told)[1]
        self.shown = [round(1e6 * float(ms.removesuffix(" ms"))) for ms in milliseconds.split(", ")]
        self.words = re.search(r"read: (.*)", self.told)[1]
        standby = re.search(r"sensors in standby for (\S+) ms of each frame", self.told)
        self.standby_ms = float(standby[1]) if standby else 0.0
        self.rows = (folder / "rows").read_bytes()


def edges_of_a_frame(firmware):
    """Idle until a frame's first line, then capture; each row computed; the last one sent after it; idle until the next."""
    phases, period = firmware.phases, 1_000_000_000 // RATE
    expect("frames shown", len(firmware.shown), FRAMES)
    expect("before the first frame", {NAMES[of] for at, _, of in phases.spans if at < firmware.shown[0]}, {"idle"})
    longest = 0
    for nth, begin in enumerate(firmware.shown[:-1]):
        expect(f"just before frame {nth}", NAMES[phases.at(begin - 1)], "idle")
        spans = [(at, end, of) for at, end, of in phases.spans if begin <= at < begin + period - 20_000_000]
        late = spans[0][0] - begin
        expect(f"the first phase of frame {nth}", NAMES[spans[0][2]], "capture")
        # The port tells of a frame with its first line.
        if late > 200 * US:
            raise Failure(f"frame {nth} was told {late / US:.0f} us late")
        longest = max(longest, late)
        computed = sum(of == COMPUTE for _, _, of in spans)
        # Each row, and the frame's end.
        if not HEIGHT <= computed <= 2 * (HEIGHT + 1) + HEIGHT:
            raise Failure(f"frame {nth} was computed in {computed} spans, of {HEIGHT} rows")
        expect(f"the last phases of frame {nth}", [NAMES[of] for _, _, of in spans[-2:]], ["send", "idle"])
        ends = [end for _, end, of in spans if of == COMPUTE][-1]
        expect(f"after the last row of frame {nth}", {NAMES[of] for at, _, of in spans if at >= ends} - {"send", "idle"}, set())
    if not phases.between:
        raise Failure("no two phases followed each other that differ in both pins")
    return (f"{len(firmware.shown) - 1} frames, each told {longest / US:.0f} us after its first line at most; of {phases.edges} edges each changes "
            f"one pin, {phases.between} phases between two others")


def standby(firmware):
    """Between frames the sensors are in standby for as long as the plan says."""
    plan = json.loads(run(HAARLINE, "power", "plan", "--board", "h743", "--size", f"{WIDTH}x{HEIGHT}", "--fps", RATE,
                          "--num-disparities", 32, "--exposure-lines", EXPOSURE, "--json"))
    planned, found = plan["budget"]["standby_percent"], firmware.standby_ms * RATE / 10
    if not 50 < found < 100 or abs(found - planned) > 1:
        raise Failure(f"in standby for {found:.1f} % of the time, planned {planned:.1f} %")
    return f"{found:.1f} % of the time, planned {planned:.1f} %; all {len(firmware.shown)} frames came"


def counters(firmware):
    """What a probe fetches fits the pins."""
    words = firmware.folder / "words.txt"
    words.write_text(firmware.words + "\n")
    recording = firmware.folder / "meter.csv"
    firmware.phases.recording(recording, 100_000)
    told = json.loads(run(HAARLINE, "power", "measure", recording, "--volts", 3.3, "--log", words, "--json"))
    values = [int(word, 16) for word in firmware.words.split()]
    clock, uptime, slept, frames = values[3:7]
    cycles = sum(low + (high << 32) for low, high in zip(values[9:-1:2], values[10:-1:2]))
    until = uptime * 1_000_000
    counted, shown = cycles / clock * 1e3, firmware.phases.time(COMPUTE, 0, until) / 1e6
    if abs(counted - shown) > 0.02 * shown:
        raise Failure(f"stages took {counted:.1f} ms by the counter, {shown:.1f} ms by the pins")
    begun = sum(begin < until for begin in firmware.shown)
    if not begun - 1 <= frames <= begun + 1:
        raise Failure(f"{frames} frames counted, {begun} shown")
    energy = sum(stage["mj_per_frame"] for stage in told["stages"]) * frames
    expected = CURRENTS[COMPUTE] * 3.3 * counted / 1e3
    if abs(energy / expected - 1) > 0.02:
        raise Failure(f"stages take {energy:.3f} mJ, and should {expected:.3f}")
    return f"stages {counted:.1f} ms by the counter, {shown:.1f} ms by the pins; asleep {slept} of {uptime} ms; clock {clock / 1e6:.0f} MHz"


def slowest(firmware, elf, dump, folder):
    """The program that chose its clock itself sends the same as the fastest one."""
    # What it says it runs at is what it is run at then.
    first = Firmware(elf, dump, folder / "first", 480)
    mhz = int(first.words.split()[3], 16) // 1_000_000
    if mhz >= 480:
        raise Failure(f"at {mhz} MHz nothing is saved")
    slow = Firmware(elf, dump, folder / "slow", mhz)
    expect("bytes sent", slow.rows == firmware.rows, True)
    edges_of_a_frame(slow)
    busy = [run.phases.time(COMPUTE) / 1e6 for run in (firmware, slow)]
    return f"{mhz} MHz: the same bytes, {busy[1]:.0f} ms of computing instead of {busy[0]:.0f}"


def measured(phases, folder, rate, *options):
    """The energies of the phases, by `power measure`, within 1 % of what went in."""
    recording = folder / "ppk2.csv"
    joules = phases.recording(recording, rate)
    told = json.loads(run(HAARLINE, "power", "measure", recording, "--volts", 3.3, "--json", *options))
    found = {line["phase"]: line["mj"] / 1e3 for line in told["phases"]}
    worst = 0
    for phase, truth in joules.items():
        error = abs(found[NAMES[phase]] - truth) / max(joules.values())
        worst = max(worst, error)
        if error > 0.01:
            raise Failure(f"{NAMES[phase]}: {found[NAMES[phase]]} J instead of {truth}")
    return told, f"energy by phase within {100 * worst:.2f} %"


def segments(elf, folder):
    """Every method works for 3 s and then sleeps for 1 s."""
    told = run(EMULATOR, elf, "--mhz", PROFILE_MHZ, "--limit", 4000 * len(METHODS) + 3200, "--phases", folder / "profile.csv",
               "--read", f"HAARLINE_FRAMES:{COUNTED}")
    end = 1_000_000 * int(re.search(r"virtual time (\d+) ms", told)[1])
    phases = Phases(folder / "profile.csv", end)
    words = [int(word, 16) for word in re.search(r"read: (.*)", told)[1].split()]
    *frames, wrong = words
    expect("frames that are not the host's", wrong, 0)
    if not all(frames):
        raise Failure(f"frames of a segment: {dict(zip(METHODS, frames))}")
    works = [(at, until) for at, until, phase in phases.spans if phase == COMPUTE]
    expect("phases", {NAMES[phase] for _, _, phase in phases.spans}, {"idle", "compute"})
    for nth, (at, until) in enumerate(works[: len(METHODS)]):
        # A frame is finished: at this clock block and sgm take a second and more for one.
        if not 3.0 <= (until - at) / 1e9 <= 3.0 + 3.2 / max(frames[nth] - 1, 1):
            raise Failure(f"{METHODS[nth]} worked for {(until - at) / 1e9:.3f} s")
    sleeps = [(until - at) / 1e9 for at, until, phase in phases.spans[1:-1] if phase == IDLE]
    if not all(0.999 <= sleep <= 1.01 for sleep in sleeps):
        raise Failure(f"slept for {sleeps} s")
    told, verdict = measured(phases, folder, 10_000, "--segments", ",".join(METHODS))
    found = [segment["name"] for segment in told["segments"]]
    expect("segments that the meter's recording shows", found[: len(METHODS)], METHODS)
    return f"frames {dict(zip(METHODS, frames))} at {PROFILE_MHZ} MHz; {verdict}"


def checks(data, folder):
    stereoboard = (ROOT / "tests" / "stereoboard.toml").read_text()
    stereoboard = re.sub(r"^wiring = .*$", 'wiring = "pairs14"', stereoboard, flags=re.M)
    stereoboard += f"frame_rate_hz = {RATE}\nexposure_lines = {EXPOSURE}\n"
    description, dump = folder / "rig.toml", folder / "dump.raw"
    description.write_text(stereoboard)
    run(HAARLINE, "record", "--recording", data / "stereoboard" / TAKE, "--layout", "side-by-side", "--first", "right",
        "--frames", "60..72", "--wiring", "pairs14", "-o", dump)
    itself = folder / "itself.elf"
    itself.write_bytes(build("firmware", HAARLINE_RIG=str(description)).read_bytes())
    elf = build("firmware", HAARLINE_RIG=str(description), HAARLINE_CLOCK_MHZ="480")
    firmware = Firmware(elf, dump, folder / "fast", 480)
    profile = build("profile")
    yield "phases at every edge of a frame", lambda: edges_of_a_frame(firmware)
    yield "sensors in standby between frames", lambda: standby(firmware)
    yield "counters as a probe fetches them", lambda: counters(firmware)
    yield "the least clock that keeps up", lambda: slowest(firmware, itself, dump, folder)
    yield "a meter's recording of the product", lambda: measured(firmware.phases, firmware.folder, 100_000)[1]
    yield "profile: 3 s of every method, 1 s of sleep", lambda: segments(profile, folder)


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__.strip())
    data = Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("HAARLINE_DATA", ROOT / "../shared/data")).resolve()
    cargo("build", "--quiet", "--release", "-p", "haarline-sim")
    cargo("build", "--quiet", "--release", "--ignore-rust-version", folder=ROOT / "firmware" / "emulator")
    with tempfile.TemporaryDirectory() as folder:
        failed = run_all(checks(data, Path(folder)))
    sys.exit(1 if failed else 0)


main()
