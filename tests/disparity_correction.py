#!/usr/bin/env python3
"""Fits the disparity correction of a real rig to one recording of a screen and holds it against another one at another
distance, both ways: `haarline align`, `haarline rig correct`, `haarline play`, compared with motion capture.

    python3 tests/disparity_correction.py HAARLINE DATA      (DATA: the folder with the recordings, stereoboard/db1_*)

Compared is the strip 0.2 m to either side of the screen's middle, in the columns that both cameras see.
"""
import csv
import math
import os
import struct
import subprocess
import sys
import tempfile

RIG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "stereoboard.toml")
FOCAL_PX, BASELINE_M = 130.0, 0.06
WIDTH, HEIGHT = 128, 96
# How the truth's bearings become columns: see tests/obstacle_truth.py.
TURN_DEG, HALF_M = 1.4, 0.2
# Rows in which the screen stands: at 3 m it ends above the floor.
ROWS = {"16": (6, 62), "18": (0, HEIGHT - 1)}
# Median error of the disparities, px, and of the depths, percent, at most, of the take that was not fitted to.
BOUNDS = {"16": (0.20, 8.0), "18": (0.20, 3.0)}


def planes(take, number):
    """Where the screen stood in each frame: depth, columns, rows."""
    with open(os.path.join(take, "frames.csv"), newline="") as file:
        for line in csv.DictReader(file):
            depth = float(line["obst_depth_m"])
            bearing = math.radians(TURN_DEG - float(line["obst_bearing_deg"]))
            middle, half = (WIDTH - 1) / 2 + FOCAL_PX * math.tan(bearing), FOCAL_PX * HALF_M / depth
            yield int(line["i"]), depth, middle - half, middle + half, *ROWS[number]


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def make_rig(haarline, take, number, folder):
    """A rig that is aligned and corrected by one take; what it was before the correction, too."""
    plain, fitted = (os.path.join(folder, f"{name}{number}.toml") for name in ("plain", "fitted"))
    with open(RIG) as file:
        text = file.read()
    assert "focal_px = 120.0" in text, RIG
    for name in (plain, fitted):
        with open(name, "w") as file:
            file.write(text.replace("focal_px = 120.0", f"focal_px = {FOCAL_PX}"))
        run(haarline, "align", take, "--layout", "side-by-side", "--first", "right", "-o", name, "--update")
    table = os.path.join(folder, "planes.csv")
    with open(table, "w", newline="") as file:
        csv.writer(file).writerows([("frame", "depth_m", "first_column", "last_column", "first_row", "last_row"), *planes(take, number)])
    told = subprocess.run(
        [haarline, "rig", "correct", take, "--layout", "side-by-side", "--rig", fitted, "--planes", table, "--update"],
        check=True, stdout=subprocess.PIPE, text=True)
    print(f"take {number}: {told.stdout}", end="")
    return plain, fitted


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"Pf\n"
        width, height = map(int, file.readline().split())
        order = "<" if float(file.readline()) < 0 else ">"
        values = struct.unpack(f"{order}{width * height}f", file.read())
    return [values[width * y:width * (y + 1)] for y in reversed(range(height))]


def median(values):
    return sorted(values)[len(values) // 2]


def score(haarline, rig, take, number, folder):
    """Median errors of disparity, px, and depth, percent; part of the pixels that is answered, percent."""
    out = os.path.join(folder, "maps")
    run(haarline, "play", take, "-o", out, "--layout", "side-by-side", "--first", "right", "--rig", rig, "--write", "disparity")
    errors, depths, pixels = [], [], 0
    maps = sorted(name for name in os.listdir(out) if name.endswith(".pfm"))
    for frame, depth, left, right, top, bottom in planes(take, number):
        truth = FOCAL_PX * BASELINE_M / depth
        rows = read_pfm(os.path.join(out, maps[frame]))
        for row in rows[top:bottom + 1]:
            for found in row[max(math.ceil(left), math.ceil(truth) + 1):max(0, min(math.floor(right), WIDTH - 1) + 1)]:
                pixels += 1
                if math.isfinite(found):
                    errors.append(abs(found - truth))
                    depths.append(abs(truth / found - 1) if found > 0 else math.inf)
    return median(errors), 100 * median(depths), 100 * len(errors) / pixels


def main(haarline, data):
    takes = {number: os.path.join(data, "stereoboard", f"db1_forward_take{number}") for number in BOUNDS}
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        rigs = {number: make_rig(haarline, take, number, folder) for number, take in takes.items()}
        for number, (most_px, most_percent) in BOUNDS.items():
            other = next(name for name in BOUNDS if name != number)
            for what, rig in zip(("without", "with"), rigs[other]):
                px, percent, answered = score(haarline, rig, takes[number], number, folder)
                print(f"take {number} {what} the correction by take {other}: {px:.3f} px, depth {percent:.1f} %, {answered:.1f} % answered")
            if px > most_px or percent > most_percent:
                failed.append(number)
    assert not failed, failed


if __name__ == "__main__":
    main(*sys.argv[1:])
