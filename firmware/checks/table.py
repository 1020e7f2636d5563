#!/usr/bin/env python3
"""Prints as Markdown what every method executes on the emulated chip, per pixel and stage, clean and at noise 10, and
the paper's Table 1 on the chip: wavelet-block against block.

usage: firmware/checks/table.py HAARLINE ELF SCENES_DIR [SCENE...]
       firmware/checks/table.py HAARLINE ELF SCENES_DIR --most METHOD[/STAGE][@NOISE]=INSTRUCTIONS...

With --most it only checks that a method's mean over four scenes at 48 disparities is not more, of all stages but packets
or of one, clean or at that noise; INSTRUCTIONS may be a share of another method's on the same frames: 0.5*block.

HAARLINE is the host's program, ELF the twin (cargo twin), SCENES_DIR the folder of scenes. The errors are those of
haarline eval: the chip's maps are the host's, byte for byte, or else haarline twin fails.
"""

import functools
import json
import subprocess
import sys
from pathlib import Path

DEFAULT = ["teddy", "kitti15_000003", "eth3d_terrace_2s"]
METHODS = ["lite", "full", "wavelet-block", "contour", "envelope"]
BLOCK_RANGES = [16, 48, 64]
# The mean of these is what a method is quoted by.
FOUR = ["teddy", "cones", "v3q_motorcycle", "kitti15_000010"]
COMPARED = [("lite", [48]), ("full", [48]), ("wavelet-block", [48]), ("contour", [48]), ("envelope", [48]),
            ("block", [16, 48, 64, 128]), ("sgm", [16, 48, 64, 128])]
RANDOM_SEED = 1
NOISES = [0, 10]
STAGES = ["unpack", "features", "contours", "seeds", "blocks", "agreement", "consistency", "output", "packets", "total"]


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

    @functools.cache
    def count(self, scene, noise, method, disparities):
        views = [self.scenes / scene / f"{view}.png" for view in ["left", "right"]]
        return run(self.haarline, "twin", *views, "--elf", self.elf, "--noise", noise, "--method", method,
                   "--num-disparities", disparities, "--json")

    def count_random(self, method, disparities):
        return run(self.haarline, "twin", "--random", "--seed", RANDOM_SEED, "--elf", self.elf, "--method", method,
                   "--num-disparities", disparities, "--json")

    def mean_of_four(self, method, disparities, noise=0, stage="total"):
        """What each of the four scenes tells, and the mean of their instructions a pixel."""
        told = [self.count(scene, noise, method, disparities) for scene in FOUR]
        return told, sum(one["instructions_per_pixel"][stage] for one in told) / len(told)

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


def mean_of_four(bench):
    """Rows: the dearest push over that run's mean push, of the four scenes the one where that is most, and absolute there;
    what is left at the frame's end, in rows."""
    rows = ["worst row / mean", "worst row", "frame end, rows"]
    head(["method", "disparities", *FOUR, "mean", *rows, "random views", *rows, "state, B", "stack, B"], 1)
    for method, ranges in COMPARED:
        for disparities in ranges:
            told, mean = bench.mean_of_four(method, disparities)
            worst, random = max(told, key=lambda one: one["worst_row_ratio"]), bench.count_random(method, disparities)
            totals = [figure(one["instructions_per_pixel"]["total"], 1) for one in [*told, random]]
            pushes = [[figure(one["worst_row_ratio"]), one["worst_row"], figure(one["frame_end_rows"], 1)]
                      for one in [worst, random]]
            memory = [random["memory"]["method_ram"], max(one["stack_high_water"] for one in told)]
            row([method, disparities, *totals[:-1], figure(mean, 1), *pushes[0], totals[-1], *pushes[1], *memory])


def check(bench, bounds):
    for bound in bounds:
        name, most = bound.split("=")
        measured, _, noise = name.partition("@")
        method, _, stage = measured.partition("/")
        noise = noise or 0
        _, mean = bench.mean_of_four(method, 48, noise, stage or "total")
        share, _, other = most.rpartition("*")
        limit = float(share) * bench.mean_of_four(other, 48, noise)[1] if share else float(most)
        print(f"{name}: {mean:.1f} instructions a pixel, at most {limit:.1f}")
        if mean > limit:
            sys.exit(f"{name} has become dearer")


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__.strip())
    bench, rest = Bench(*sys.argv[1:4]), sys.argv[4:]
    if "--most" in rest:
        return check(bench, [bound for bound in rest if bound != "--most"])
    scenes = rest or DEFAULT
    mean_of_four(bench)
    print()
    costs(bench, scenes)
    print()
    table_1(bench, scenes)


main()
