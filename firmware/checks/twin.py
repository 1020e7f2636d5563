#!/usr/bin/env python3
"""Shows that the application on the emulated chip does what it shall: the host's bytes, the same counts in every run,
no harm from any fault of the camera beyond the frame it hits, and nothing that grows with time.

usage: firmware/checks/twin.py HAARLINE ELF DATA

HAARLINE is the host's program, ELF the twin (cargo twin), DATA the folder with qvga and stereoboard.
"""

import json
import subprocess
import sys
import tempfile
from functools import cached_property
from pathlib import Path

from verdicts import Failure, expect, run_all, within

SCENE, LOW_SCENE = "teddy", "kitti15_000003"
TAKE, TAKE_ROWS = "db1_forward_take01", 96
WIRINGS = ["pixel", "line", "side-by-side", "nibble", "pairs16"]
CLEAN = {"dma_errors": 0, "dropped_frames": 0, "dropped_rows": 0, "long": 0, "overruns": 0, "short": 0, "stalled": 0}
# What each fault in the middle of frame 1 of four must leave in the counters, and which frames may differ. None: how
# many rows of a burst come too soon depends on the method's speed.
FAULTS = {
    "lost-line": ({"dropped_rows": 1, "rows": 4 * TAKE_ROWS}, [1]),
    "short": ({"short": 1, "rows": 7 * TAKE_ROWS // 2}, [1]),
    "long": ({"long": 1, "rows": 4 * TAKE_ROWS}, []),
    "overrun": ({"overruns": 1, "rows": 7 * TAKE_ROWS // 2}, [1]),
    "garbage": ({"dropped_rows": 4, "rows": 4 * TAKE_ROWS}, [1]),
    "stall": ({"stalled": 1, "rows": 7 * TAKE_ROWS // 2}, [1]),
    "burst": ({"dropped_frames": 1, "rows": None}, [1]),
}
LONG_RUN, SHORT_RUN = 10_000, 10
# Of the long run's frames: small, so that it is over soon.
SMALL, SMALL_FRAMES = (64, 24), 4


class Twin:
    def __init__(self, haarline, elf, data, folder):
        self.haarline, self.elf, self.folder = haarline, elf, folder
        self.scenes, self.take = data / "qvga", data / "stereoboard" / TAKE

    def host(self, *arguments):
        done = subprocess.run([self.haarline, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(f"haarline {arguments[0]}, exit status {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def text(self, *arguments):
        return self.host("twin", "--elf", self.elf, "--json", *arguments)

    def run(self, *arguments):
        return json.loads(self.text(*arguments))

    def scene(self, name, method):
        folder = self.scenes / name
        disparities = json.loads((folder / "meta.json").read_text())["num_disparities"]
        return [folder / "left.png", folder / "right.png", "--method", method, "--num-disparities", disparities]

    def recording(self, method="lite"):
        return ["--recording", self.take, "--layout", "side-by-side", "--first", "right", "--method", method,
                "--num-disparities", 32]

    def maps(self, name, *arguments):
        """What the run tells, and the bytes of its maps by frame."""
        target = self.folder / name
        target.mkdir(exist_ok=True)
        told = self.run("--min-confidence", "0", "-o", target / "map.pfm", *arguments)
        return told, [path.read_bytes() for path in sorted(target.iterdir())]

    @cached_property
    def side_by_side(self):
        return self.maps("side_by_side", *self.scene(LOW_SCENE, "lite"))

    @cached_property
    def clean(self):
        return self.maps("clean", *self.recording(), "--count", 4)


def scene(twin, name, method):
    evaluated = twin.folder / f"eval_{name}_{method}"
    twin.host("eval", twin.scenes, "--only", name, "--method", method, "-o", evaluated)
    told, [found] = twin.maps(f"scene_{name}_{method}", *twin.scene(name, method))
    expect("maps unlike the host's", told["different_frames"], [])
    if found != (evaluated / f"{name}.pfm").read_bytes():
        raise Failure("the map is not that of haarline eval")
    return f"{told['instructions_per_pixel']['total']:.1f} instructions/px"


def recording(twin):
    told = twin.run(*twin.recording())
    frames = len(list(twin.take.glob("*.bmp")))
    expect("frames compared", told["compared"], frames)
    expect("maps unlike the host's", told["different_frames"], [])
    expect("counters", told["counters"], {**CLEAN, "frames": frames, "rows": frames * TAKE_ROWS})
    return f"{frames} frames"


def rig(twin, row_offset):
    """The recording's own rig: offsets, and obstacles whose angles the chip works out."""
    text = (Path(__file__).parents[2] / "tests" / "stereoboard.toml").read_text()
    path = twin.folder / f"rig_{row_offset}.toml"
    path.write_text(text.replace("row_offset = 0", f"row_offset = {row_offset}"))
    told = twin.run("--recording", twin.take, "--layout", "side-by-side", "--first", "right", "--method", "lite", "--rig", path)
    expect("maps unlike the host's", told["different_frames"], [])
    expect("obstacles unlike the host's", told["different_obstacles"], [])
    expect("frames whose obstacles were compared", told["obstacles_compared"], told["frames"])
    return f"{told['frames']} frames"


def repeatable(twin):
    arguments = twin.scene(SCENE, "full")
    if twin.text(*arguments) != twin.text(*arguments):
        raise Failure("two runs tell different things")
    return ""


def machines(twin):
    arguments = twin.scene(SCENE, "full")
    (first, first_map), (second, second_map) = (
        twin.maps(machine, "--machine", machine, *arguments) for machine in ["an386", "an500"]
    )
    expect("the machines", [first["machine"], second["machine"]], ["an386", "an500"])
    if first_map != second_map:
        raise Failure("they make different maps")
    expect("instructions", second["instructions_per_pixel"], first["instructions_per_pixel"])
    return ""


def wiring(twin, name):
    told, found = twin.maps(f"wiring_{name}", *twin.scene(LOW_SCENE, "lite"), "--wiring", name, "--first", "right")
    expect("the wiring", [told["wiring"], told["first"]], [name, "right"])
    if found != twin.side_by_side[1]:
        raise Failure("the map is another than side by side")
    return ""


def seven_bits(twin):
    told = twin.run(*twin.scene(LOW_SCENE, "lite"), "--wiring", "pairs14")
    expect("maps unlike the host's", told["different_frames"], [])
    return ""


def skew(twin, camera):
    told = twin.run(*twin.scene(LOW_SCENE, "lite"), "--wiring", "pixel", "--skew", camera)
    expect("the skew", told["skew"], camera)
    expect("maps unlike the host's", told["different_frames"], [])
    return ""


def fault(twin, kind):
    counters, damaged = FAULTS[kind]
    told, found = twin.maps(f"fault_{kind}", *twin.recording(), "--count", 4, "--fault", f"{kind}@1")
    expected = {**CLEAN, "frames": 4, **counters}
    if expected["rows"] is None:
        rows = expected["rows"] = told["counters"]["rows"]
        if not 3 * TAKE_ROWS <= rows < 4 * TAKE_ROWS:
            raise Failure(f"{rows} rows")
    expect("counters", told["counters"], expected)
    expect("maps unlike the host's", told["different_frames"], damaged)
    for frame in [0, 2, 3]:
        if found[frame] != twin.clean[1][frame]:
            raise Failure(f"frame {frame} is not that of a run without the fault")
    return ""


def small_recording(twin):
    """A raw dump of a few clippings of a scene."""
    name = SCENE
    size = json.loads((twin.scenes / name / "meta.json").read_text())
    whole, clipped = twin.folder / "whole.raw", twin.folder / "small.raw"
    views = [twin.scenes / name / f"{view}.png" for view in ["left", "right"]]
    twin.host("record", *views, "--wiring", "side-by-side", "-o", whole)
    stride = 2 * size["width"]
    raw = whole.read_bytes()
    rows = [raw[start : start + stride] for start in range(0, len(raw), stride)]
    width, height = SMALL
    with clipped.open("wb") as file:
        for frame in range(SMALL_FRAMES):
            for row in rows[frame * 50 : frame * 50 + height]:
                for start in [frame * 40, size["width"] + frame * 40]:
                    file.write(row[start : start + width])
    return ["--recording", clipped, "--raw", f"{width}x{height}", "--wiring", "side-by-side",
            "--method", "full", "--num-disparities", 16]


def endurance(twin):
    arguments = small_recording(twin)
    few, many = (twin.run(*arguments, "--count", frames) for frames in [SHORT_RUN, LONG_RUN])
    expect("counters", many["counters"], {**CLEAN, "frames": LONG_RUN, "rows": LONG_RUN * SMALL[1]})
    expect("frames compared", many["compared"], LONG_RUN)
    expect("maps unlike the host's", many["different_frames"], [])
    expect("stack high-water mark, bytes", many["stack_high_water"], few["stack_high_water"])
    # A clock that passes another power of two costs an instruction or two; what grows with time would cost more.
    within("worst row, instructions", many["worst_row"], few["worst_row"], few["worst_row"] // 1000)
    return f"stack {many['stack_high_water']} B after {SHORT_RUN} and after {LONG_RUN} frames"


def checks(twin):
    """Every check by its name."""
    for name in sorted(path.parent.name for path in twin.scenes.glob("*/meta.json")):
        for method in ["lite", "full"]:
            yield f"{name}, {method}: the host's map", lambda n=name, m=method: scene(twin, n, m)
    yield f"recording {TAKE}, right first: the host's maps", lambda: recording(twin)
    for rows in [-2, 0, 1]:
        yield f"recording {TAKE} with its rig, row offset {rows}: maps, obstacles", lambda r=rows: rig(twin, r)
    yield "two runs tell the same", lambda: repeatable(twin)
    yield "an386 and an500: the same map and counts", lambda: machines(twin)
    for name in WIRINGS:
        yield f"wiring {name}: the same map", lambda n=name: wiring(twin, n)
    yield "wiring pairs14: the host's map at seven bits", lambda: seven_bits(twin)
    for camera in ["left", "right"]:
        yield f"skew {camera}: the host's map", lambda c=camera: skew(twin, c)
    for kind in FAULTS:
        yield f"fault {kind}: counted, and the other frames as without it", lambda k=kind: fault(twin, k)
    yield f"{LONG_RUN} frames: none lost, no drift, the same stack", lambda: endurance(twin)


def main(checks, usage):
    """Runs the checks of the twin that the arguments name."""
    if len(sys.argv) != 4:
        sys.exit(usage.strip())
    haarline, elf, data = (Path(argument).resolve() for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        failed = run_all(checks(Twin(haarline, elf, data, Path(folder))))
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main(checks, __doc__)
