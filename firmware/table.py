#!/usr/bin/env python3
"""Prints as Markdown what every method executes on the emulated chip, per pixel and stage, clean and at noise 10, and
the paper's Table 1 on the chip: wavelet-block against block.

usage: firmware/table.py HAARLINE ELF SCENES_DIR [SCENE...]

HAARLINE is the host's program, ELF the twin (cargo twin), SCENES_DIR the folder of scenes. The errors are those of
haarline eval: the chip's maps are the host's, byte for byte, or else haarline twin fails.
"""

import json
import subprocess
import sys
from pathlib import Path

DEFAULT = ["teddy", "kitti15_000003", "eth3d_terrace_2s"]
METHODS = ["lite", "full", "wavelet-block", "contour", "envelope"]
BLOCK_RANGES = [16, 48, 64]
NOISES = [0, 10]
STAGES = ["unpack", "features", "contours", "seeds", "blocks", "agreement", "consistency", "output", "total"]


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{arguments[0]} {arguments[1]} failed with exit status {done.returncode}")
    return json.loads(done.stdout)


class Bench:
    def __init__(self, haarline, elf, scenes):
        self.haarline, self.elf, self.scenes = haarline, elf, Path(scenes)

    def disparities(self, scene):
        return json.loads((self.scenes / scene / "meta.json").read_text())["num_disparities"]

    def count(self, scene, noise, method, disparities):
        views = [self.scenes / scene / f"{view}.png" for view in ["left", "right"]]
        return run(self.haarline, "twin", *views, "--elf", self.elf, "--noise", noise, "--method", method,
                   "--num-disparities", disparities, "--json")

    def score(self, scene, noise, method):
        scored = run(self.haarline, "eval", self.scenes, "--only", scene, "--noise", noise, "--method", method,
                     "--json", "-")
        return scored["scenes"][scene]


def row(cells):
    print(f"| {' | '.join(str(cell) for cell in cells)} |")


def head(names, words):
    row(names)
    row(["---"] * words + ["---:"] * (len(names) - words))


def figure(value, digits=2):
    return "–" if value is None else f"{value:.{digits}f}"


def costs(bench, scenes):
    """One line a method, scene and noise. Errors where the range is the scene's own."""
    head(["scene", "noise", "method", "disparities", *STAGES, "worst row", "state, B", "density, %", "tot2, %"], 3)
    for scene in scenes:
        own = bench.disparities(scene)
        ranges = sorted({own, *BLOCK_RANGES})
        for noise in NOISES:
            for method, disparities in [(m, own) for m in METHODS] + [("block", d) for d in ranges]:
                told = bench.count(scene, noise, method, disparities)
                score = bench.score(scene, noise, method) if disparities == own else {}
                counts = [figure(told["instructions_per_pixel"][stage], 1) for stage in STAGES]
                memory = told["memory"]["method_ram"]
                errors = [figure(score.get(key), 1) for key in ["density", "tot2"]]
                row([scene, noise, method, disparities, *counts, told["worst_row"], memory, *errors])


def table_1(bench, scenes):
    """Location error: mean over the answered pixels, px."""
    names = ["instructions/px", "location error, px", "bad2, %", "density, %", "tot2, %"]
    head(["scene", "noise", "method", *names], 3)
    for scene in scenes:
        for noise in NOISES:
            for method in ["block", "wavelet-block"]:
                told = bench.count(scene, noise, method, bench.disparities(scene))
                score = bench.score(scene, noise, method)
                errors = [figure(score.get(key)) for key in ["epe", "bad2", "density", "tot2"]]
                row([scene, noise, method, figure(told["instructions_per_pixel"]["total"], 1), *errors])


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__.strip())
    bench, scenes = Bench(*sys.argv[1:4]), sys.argv[4:] or DEFAULT
    costs(bench, scenes)
    print()
    table_1(bench, scenes)


main()
