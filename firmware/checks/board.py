#!/usr/bin/env python3
"""Shows that the board's program, as `cargo run --release` flashes it, does what it shall on an emulated STM32H743:
builds it for several rigs, plays recordings through sensors, DCMI, DMA and interrupts, and compares what leaves the
serial ports with what the host makes of the same bytes. Camera faults, a program that hangs and one that crashes too.

usage: firmware/checks/board.py [DATA [FRAMES]]

With FRAMES only the scene is played, so many frames of it (300 take six minutes), to the program built with
`--profile firmware`. DATA is the folder with qvga and stereoboard (default: $HAARLINE_DATA or ../shared/data beside the project). Needs pymavlink
(pip install pymavlink). ARM_TOOLCHAIN names a toolchain with the target thumbv7em-none-eabihf, if the usual one has it not. The
emulator, a package of its own, takes some minutes to build for the first time.
"""

import csv
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verdicts import Failure, expect, run_all

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

# What is built here runs at the clock of the emulated chip, whatever else would do for the rig.
os.environ.setdefault("HAARLINE_CLOCK_MHZ", "480")

ROOT = Path(__file__).resolve().parents[2]
TARGET = "thumbv7em-none-eabihf"
TARGET_DIR = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
# A toolchain of its own has a folder of its own, so that neither builds all anew for the other.
ARM_TOOLCHAIN = os.environ.get("ARM_TOOLCHAIN")
ARM_DIR = TARGET_DIR / "arm" if ARM_TOOLCHAIN else TARGET_DIR
HAARLINE, EMULATOR = TARGET_DIR / "release" / "haarline", TARGET_DIR / "release" / "haarline-emulator"

SCENE, TAKE = "tsukuba", "db1_forward_take01"
UNKNOWN = 65535
# Of the row packets' port.
BAUD = 12_000_000
# What each fault in the middle of frame 1 leaves in the counters; in a clean run all are 0.
COUNTERS = ["dropped_rows", "dropped_frames", "overruns", "short", "long", "stalled", "dma_errors"]
FAULTS = {"short": {"short": 1}, "long": {"long": 1}, "overrun": {"overruns": 1}, "stall": {"stalled": 1}, "garbage": {}}
# Of mistakes in the wires: frames until it is told, and what the log says.
MISTAKES = {
    "another:2": (4, r"sensor 2 is no MT9V034 but model 0x1313"),
    "no-master-clock": (4, r"no answer from sensor 1 .*check its wires, its supply and its master clock"),
    "no-pixel-clock": (60, r"camera: silent"),
    "no-crystal": (4, r"the crystal does not start: running by the chip's own oscillator"),
}
# Frames a second of the reference rig.
REFERENCE_RATE = 30


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Failure(f"{Path(command[0]).name}, exit status {done.returncode}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def cargo(*arguments, folder=ROOT, target_dir=TARGET_DIR, **variables):
    run("cargo", *arguments, cwd=folder, env={**os.environ, "CARGO_TARGET_DIR": str(target_dir), **variables})


class Rig:
    """A rig description, the program for it, and a dump of what its cameras see."""

    def __init__(self, folder, name, text, **changes):
        self.name, self.folder = name, folder / name
        self.sensor = "mt9v034" if changes.get("wiring") == '"pairs14"' else "hm01b0"
        self.folder.mkdir()
        for field, value in changes.items():
            text = re.sub(rf"^{field} = .*$", f"{field} = {value}", text, flags=re.M)
        self.description = self.folder / "rig.toml"
        self.description.write_text(text)
        number = lambda field: int(re.search(rf"^{field} = (-?\d+)", text, re.M)[1])
        self.width, self.height, self.rate = number("width"), number("height"), number("frame_rate_hz")
        self.method, self.elf, self.dump = "full", self.folder / "firmware.elf", self.folder / "dump.raw"

    def build(self, program="firmware", profile="release"):
        variables = {"RUSTUP_TOOLCHAIN": ARM_TOOLCHAIN} if ARM_TOOLCHAIN else {}
        cargo("build", "--quiet", "-p", "haarline-firmware", "--profile", profile, "--target", TARGET, "--bin", program,
              target_dir=ARM_DIR, HAARLINE_RIG=str(self.description), HAARLINE_METHOD=self.method, **variables)
        # Kept: the next rig's program takes its place.
        self.elf.write_bytes((ARM_DIR / TARGET / profile / program).read_bytes())

    def host(self):
        """What the host makes of the dump: maps and messages."""
        out, messages = self.folder / "host", self.folder / "host.mavlink"
        run(HAARLINE, "play", self.dump, "--raw", f"{self.width}x{self.height}", "--rig", self.description, "-o", out,
            "--mavlink", messages, "--method", self.method)
        self.maps = [path.read_bytes() for path in sorted(out.glob("*.pfm"))]
        self.distances = [list(message.distances) for message in obstacles(decode(messages.read_bytes()))]

    def emulate(self, name, frames, *options):
        return Emulated(self, name, frames, options)


class Emulated:
    """A run of a rig's program, and what it left."""

    def __init__(self, rig, name, frames, options):
        self.rig, out = rig, rig.folder / name
        out.mkdir()
        self.told = run(EMULATOR, rig.elf, "--raw", rig.dump, "--size", f"{rig.width}x{rig.height}", "--frames", frames,
                        "--sensor", rig.sensor, "--rows", out / "rows", "--mavlink", out / "mavlink", "--log", out / "log", *options)
        self.rows, self.log = (out / "rows").read_bytes(), (out / "log").read_text()
        # The watchdog may strike in the middle of a message.
        self.mavlink = [] if "hang@1" in options else decode((out / "mavlink").read_bytes(), may_end_early=True)
        run(HAARLINE, "receive", out / "rows", "-o", out / "maps")
        self.maps = {path.stem: path.read_bytes() for path in (out / "maps").glob("*.pfm")}
        with open(out / "maps" / "frames.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.counters, self.numbers = table[-1], [int(line["frame"]) for line in table]
        # Two HM01B0 are set up as one.
        for number in [1, 2] if rig.sensor == "mt9v034" else [1]:
            self.says(f"sensor {number}: {rig.sensor.upper()} set up")
        if "bytes that are no log" in self.log:
            raise Failure(f"the log does not decode:\n{self.log}")

    def says(self, words):
        if words not in self.log:
            raise Failure(f"the log does not say {words!r}:\n{self.log}")

    def counted(self, **wanted):
        found = {name: int(self.counters[name]) for name in COUNTERS}
        expect("counters", found, {**dict.fromkeys(COUNTERS, 0), **wanted})

    def maps_as_on_the_host(self, frames):
        """`frames`: names of the chip's frames, each with the number of the host's."""
        for name, number in frames.items():
            if name not in self.maps:
                raise Failure(f"frame {name} never came")
            if self.maps[name] != self.rig.maps[number % len(self.rig.maps)]:
                raise Failure(f"the map of frame {name} is not the host's")

    def clean(self, frames):
        self.maps_as_on_the_host({f"{number:06}": number for number in range(frames)})
        self.counted()
        expect("frames begun", int(self.counters["frames"]), frames)
        found = obstacles(self.mavlink)
        expect("messages about obstacles", len(found), frames)
        for number, message in enumerate(found):
            wanted = self.rig.distances[number % len(self.rig.distances)]
            expect(f"distances of frame {number}", list(message.distances), wanted)
        times = [message.time_usec for message in found]
        period = 1_000_000 // self.rig.rate
        if any(abs(later - earlier - period) > period // 100 for earlier, later in zip(times, times[1:])):
            raise Failure(f"frames began at {times} us, and should come every {period}")
        return found


def decode(raw, may_end_early=False):
    """Messages, of which every byte must be one's; a run may end in the middle of the last."""
    decoder = mavlink.MAVLink(None)
    decoder.robust_parsing = False  # a bad byte is an error, not something to be skipped
    messages = decoder.parse_buffer(bytearray(raw)) or []
    rest = raw[sum(len(message.get_msgbuf()) for message in messages) :]
    # The length of what a message carries is its second byte.
    if rest and not (may_end_early and rest[0] == 0xFD and (len(rest) < 2 or len(rest) < 12 + rest[1])):
        raise Failure("bytes that are no message")
    for message in messages:
        expect("the sender", (message.get_srcSystem(), message.get_srcComponent()), (1, 196))
    return messages


def obstacles(messages):
    return [message for message in messages if message.get_type() == "OBSTACLE_DISTANCE"]


def self_test(rig):
    log = rig.folder / "log"
    run(EMULATOR, rig.elf, "--limit", 400, "--log", log)
    text = log.read_text()
    if "self test passed" not in text or "FAILED" in text or text.count(" ok\n") < 6:
        raise Failure(text)
    return "\n" + "\n".join("       " + re.sub(r"^\S+ info ", "", line) for line in text.splitlines())


def scene(rig, frames):
    first = rig.emulate("scene", frames, "--limit", 1000 * frames // rig.rate + 2000)
    first.clean(frames)
    second = rig.emulate("again", 6).rows
    # The second run ends before its last rows.
    common = len(second) * 5 // 6
    expect("two runs send the same bytes", first.rows[:common] == second[:common], True)
    expect("bits of the sensors", re.search(r"bits of the sensors: (.*)", first.told)[1], "7 and 7")
    for pattern in [r"started by power", r"frames \d+, rows \d+; lost rows 0, .* silences 0", r"cycles: unpack \d+, rectify \d+, features",
                    r"asleep \d\d? percent, stack at most \d+ B"]:
        if not re.search(pattern, first.log):
            raise Failure(f"the log has no {pattern!r}:\n{first.log}")
    beats = [message for message in first.mavlink if message.get_type() == "HEARTBEAT"]
    expect("heartbeats", [beat.system_status for beat in beats], [mavlink.MAV_STATE_ACTIVE] * len(beats))
    if not beats:
        raise Failure("no heartbeat came")
    latency = re.search(r"from the end of the integration to the last row's packet at most (.*) ms", first.told)
    bytes_a_second = len(first.rows) * rig.rate // frames
    busy = 100 * 10 * bytes_a_second // BAUD
    if busy > 80:
        raise Failure(f"the row packets take {busy} percent of the wire")
    return f"{rig.rate} frames a second, {re.findall(r'asleep .*', first.log)[-1]}, {latency[1]} ms from exposure to the last row, wire {busy} percent busy"


def rover(rig):
    """The post at 1.5 m, through four data lines a sensor and past a displaced right view."""
    emulated = rig.emulate("rover", 3)
    expect("bits of the sensors", re.search(r"bits of the sensors: (.*)", emulated.told)[1], "4 and 4")
    posts = []
    for message in emulated.clean(3):
        expect("increment and offset", (message.increment, message.angle_offset), (5, -40.0))
        by_bearing = {-40 + 5 * nth: cm for nth, cm in enumerate(message.distances)}
        posts.append(by_bearing.pop(0))
        if not 140 <= posts[-1] <= 160:
            raise Failure(f"the post at 150 cm reads {posts[-1]}")
        # The post may reach into the sectors beside its own.
        beside = [by_bearing.pop(bearing) for bearing in (-5, 5)]
        if not all(cm == UNKNOWN or cm > 400 or 140 <= cm <= 160 for cm in beside):
            raise Failure(f"beside the post at 150 cm: {beside}")
        wrong = {bearing: cm for bearing, cm in by_bearing.items() if cm != UNKNOWN and cm < 400}
        expect("obstacles where none is", wrong, {})
    return f"the post at 150 cm reads {posts[-1]}, nothing nearer than 4 m elsewhere"


def recording(rig, frames=None):
    frames = frames or len(rig.maps)
    rig.emulate("recording", frames).clean(frames)
    return f"{frames} frames, {rig.rate} a second"


def fault(rig, kind):
    emulated = rig.emulate(kind, 4, "--fault", f"{kind}@1")
    wanted = FAULTS[kind]
    if kind == "garbage":
        # Lines from the first that is too short to the frame's end; noise takes long, so that the frame may end early.
        rows, frames = (int(emulated.counters[name]) for name in ["dropped_rows", "dropped_frames"])
        if not (1 <= rows <= rig.height // 2 and frames <= 1):
            raise Failure(f"{rows} rows and {frames} frames lost")
        wanted = {"dropped_rows": rows, "dropped_frames": frames}
    emulated.counted(**wanted)
    expect("frames begun", int(emulated.counters["frames"]), 4)
    good = [number for number in range(4) if number != 1 or kind == "long"]
    emulated.maps_as_on_the_host({f"{number:06}": number for number in good})
    return ", ".join(f"{name} {count}" for name, count in wanted.items())


def silent(rig):
    emulated = rig.emulate("silent", 3, "--fault", "silent")
    # The second sensor is asked when the first one has answered.
    complaint = re.search(r"no answer from sensor 1 \(I2C, PB8, PB9, .*: check its wires.*", emulated.log)
    if not complaint:
        raise Failure(f"the log does not complain:\n{emulated.log}")
    emulated.maps_as_on_the_host({f"{number:06}": number for number in range(3)})
    return complaint[0]


def nak(rig):
    emulated = rig.emulate("nak", 3, "--fault", "nak")
    if "ERROR" in emulated.log or "error" in emulated.log:
        raise Failure(f"a sensor that is slow after its reset is complained of:\n{emulated.log}")
    emulated.maps_as_on_the_host({f"{number:06}": number for number in range(3)})
    return ""


def mistaken(rig, mistake, frames, words):
    """A mistake in the wires is named, and the program goes on."""
    log = rig.folder / f"{mistake}.log"
    run(EMULATOR, rig.elf, "--raw", rig.dump, "--size", f"{rig.width}x{rig.height}", "--sensor", rig.sensor,
        "--frames", frames, "--limit", 1500, "--wires", mistake, "--log", log)
    found = re.search(words, log.read_text())
    if not found:
        raise Failure(f"the log does not say {words!r}:\n{log.read_text()}")
    return found[0]


def struck(rig, kind, frames, words):
    """A program that hangs or crashes in frame 1 is started anew, and then all is as it was."""
    emulated = rig.emulate(kind, frames, "--fault", f"{kind}@1")
    for text in words:
        emulated.says(text)
    # Frames are counted from 0 again; the names of those after it go on with _1.
    numbers = emulated.numbers
    reset = max(at for at, number in enumerate(numbers) if number == 0)
    names = [f"{number:06}_1" for number in numbers[reset:]]
    if reset == 0 or len(names) < 3:
        raise Failure(f"frames {numbers} came, and there should be some from 0 on again")
    # The cameras went on meanwhile: whichever frame comes first then.
    first = next((n for n, good in enumerate(rig.maps) if good == emulated.maps["000000_1"]), None)
    if first is None:
        raise Failure("the first frame after the reset is none of the host's")
    emulated.maps_as_on_the_host({name: first + nth for nth, name in enumerate(names)})
    emulated.counted()
    return f"{re.search(r'reset at .*', emulated.told)[0]}, then {len(names)} good frames"


def displaced(dump, rig, rows, wiring):
    """A pixel-interleaved dump, its right view moved down by `rows`, as the rig's wiring would store it."""
    stride = 2 * rig.width
    lines = [dump[start : start + stride] for start in range(0, len(dump), stride)]
    moved = bytearray()
    for y, line in enumerate(lines):
        left, right = line[0::2], lines[max(y - rows, 0)][1::2]
        for a, b in zip(left, right):
            # The high halves first; the first camera is on the low four lines.
            moved += bytes([a >> 4 | b & 0xF0, a & 15 | (b & 15) << 4]) if wiring == "nibble" else bytes([a, b])
    return bytes(moved)


def checks(data, folder, only_frames=None):
    # Long enough for what is told once a second.
    frames = only_frames or REFERENCE_RATE + 5
    template = folder / "rig.toml"
    run(HAARLINE, "rig", "new", template)
    template = template.read_text()

    plain = Rig(folder, "scene", template, wiring='"pairs14"', frame_rate_hz=REFERENCE_RATE)
    views = [data / "qvga" / SCENE / f"{view}.png" for view in ["left", "right"]]
    run(HAARLINE, "record", *views, "--wiring", "pairs14", "-o", plain.dump)
    if only_frames:
        plain.build(profile="firmware")
        plain.host()
        yield f"two MT9V034, scene {SCENE}, 320x240, {frames} frames: maps, obstacles, log", lambda: scene(plain, frames)
        return

    ground = Rig(folder, "rover", template, wiring='"nibble"', row_offset=2, exposure_lines=120, frame_rate_hz=4)
    run(HAARLINE, "demo", "--scene", "rover", "-o", ground.folder / "demo")
    views = [ground.folder / "demo" / f"{view}.png" for view in ["left", "right"]]
    run(HAARLINE, "record", *views, "--wiring", "pixel", "-o", ground.folder / "pixel.raw")
    ground.dump.write_bytes(displaced((ground.folder / "pixel.raw").read_bytes(), ground, 2, "nibble"))

    stereoboard = (ROOT / "tests" / "stereoboard.toml").read_text() + "frame_rate_hz = 10\n"
    take = Rig(folder, "take", stereoboard, wiring='"pairs14"', exposure_lines=40, frame_rate_hz=30)
    lite = Rig(folder, "lite", stereoboard, wiring='"pixel"', row_offset=-1, frame_rate_hz=15)
    lite.method = "lite"
    for rig, wiring in [(take, "pairs14"), (lite, "pixel")]:
        run(HAARLINE, "record", "--recording", data / "stereoboard" / TAKE, "--layout", "side-by-side", "--first", "right",
            "--frames", "60..72", "--wiring", wiring, "-o", rig.dump)

    bare = Rig(folder, "bare", template)
    bare.build("selftest")
    # 39 rows wait to be rectified, and come at once at the end of a frame.
    rolled = Rig(folder, "rolled", template, wiring='"pairs14"', frame_rate_hz=20, roll_deg=4)
    rolled.dump.write_bytes(plain.dump.read_bytes())
    for rig in [plain, ground, take, lite, rolled]:
        rig.build()
        rig.host()
    yield "self test: every method's checksum is the host's", lambda: self_test(bare)
    yield f"two MT9V034, scene {SCENE}, 320x240, twice: maps, obstacles, log", lambda: scene(plain, frames)
    yield "a rig rolled by 4 degrees: maps, obstacles", lambda: recording(rolled, 4)
    yield "two HM01B0, rover, nibbles, two rows displaced: maps, the post", lambda: rover(ground)
    yield f"two MT9V034, recording {TAKE}: maps, obstacles", lambda: recording(take)
    yield f"two HM01B0, recording {TAKE}, lite: maps, obstacles", lambda: recording(lite)
    for rig in [plain, take]:
        for kind in FAULTS:
            name = f"fault {kind}, {rig.width}x{rig.height}: counted, and the other frames as without it"
            yield name, lambda r=rig, k=kind: fault(r, k)
    yield "no sensor answers for 300 ms: told, and all is well after", lambda: silent(plain)
    yield "no sensor answers for 300 ms after its reset: waited for", lambda: nak(plain)
    for mistake, (frames, words) in MISTAKES.items():
        yield f"{mistake}: named", lambda m=mistake, f=frames, w=words: mistaken(take, m, f, w)
    yield "the program hangs: the watchdog starts it anew", lambda: struck(
        take, "hang", 90, ["by the watchdog", "started by the watchdog: the vision task stood still"])
    yield "the program crashes: it starts anew", lambda: struck(
        take, "crash", 12, ["hard fault at", "by the program itself", "started by the program itself"])


def main():
    if len(sys.argv) > 3 or not all(word.isdigit() for word in sys.argv[2:]):
        sys.exit(__doc__.strip())
    frames = int(sys.argv[2]) if len(sys.argv) > 2 else None
    data = Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("HAARLINE_DATA", ROOT / "../shared/data")).resolve()
    cargo("build", "--quiet", "--release", "-p", "haarline-sim")
    cargo("build", "--quiet", "--release", "--ignore-rust-version", folder=ROOT / "firmware" / "emulator")
    with tempfile.TemporaryDirectory() as folder:
        failed = run_all(checks(data, Path(folder), frames), threads=2)
    sys.exit(1 if failed else 0)


main()
