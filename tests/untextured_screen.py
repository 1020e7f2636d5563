#!/usr/bin/env python3
"""How many of the sure pixels of a screen without texture are wrong by more than 2 px, in a recording of a real rig that
moves past it at 3 m (take 13): of the middle 0.4 m of the screen, where motion capture says it is.

    python3 tests/untextured_screen.py HAARLINE DATA [--method full,lite]      (needs numpy; DATA: the folder with the
                                                                                recordings, stereoboard/db1_*)
"""
import argparse
import csv
import os
import subprocess
import tempfile

import numpy

from obstacle_truth import RIG, TAKES

TAKE = next(take for take in TAKES if take.name == "db1_forward_take13")
# Half of the strip, m; the rows in which there is nothing but screen, whatever the pitch.
STRIP_M, ROWS = 0.2, slice(8, 60)
# Of the rig: focal length, px, and the middle column; disparity x depth, px m, after the column offset of 5 px.
FOCAL_PX, MIDDLE, PX_M = 120, 63.5, 7.8
SURE, WRONG_PX = 64, 2
# Wrong ones among the sure, percent, at most.
MOST = 1.4


def strip(truth):
    """The columns of the strip; None where a part of it is not in the view."""
    bearing = numpy.radians(TAKE.turn_deg - float(truth["obst_bearing_deg"]))
    column, half = MIDDLE + FOCAL_PX * numpy.tan(bearing), FOCAL_PX * STRIP_M / float(truth["obst_depth_m"])
    # Left of the greatest disparities the right view shows nothing.
    return slice(round(column - half), round(column + half) + 1) if 8 <= column - half and column + half < 120 else None


def measure(haarline, method, take, folder):
    options = ["--layout", "side-by-side", "--first", "right", "--rig", RIG, "--method", method, "--write", "npy"]
    command = [haarline, "play", take, "-o", folder, *options, "--min-confidence", str(SURE), "--json"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(take, "frames.csv"), newline="") as file:
        truth = list(csv.DictReader(file))
    frames = pixels = sure = wrong = near = 0
    for line in truth:
        columns = strip(line)
        if columns is None:
            continue
        found = numpy.load(os.path.join(folder, os.path.splitext(line["src"])[0] + ".npy"))[ROWS, columns]
        off = found[numpy.isfinite(found)] - PX_M / float(line["obst_depth_m"])
        frames, pixels, sure = frames + 1, pixels + found.size, sure + off.size
        wrong, near = wrong + int((abs(off) > WRONG_PX).sum()), near + int((off > WRONG_PX).sum())
    return frames, pixels, sure, wrong, near


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("haarline")
    parser.add_argument("data")
    parser.add_argument("--method", default="full,lite")
    arguments = parser.parse_args()
    take = os.path.join(arguments.data, "stereoboard", TAKE.name)
    for method in arguments.method.split(","):
        with tempfile.TemporaryDirectory() as folder:
            frames, pixels, sure, wrong, near = measure(
                os.path.abspath(arguments.haarline), method, take, os.path.join(folder, "out"))
        assert frames > 50 and sure > 0.02 * pixels, f"{method}: {sure} sure pixels of {pixels} in {frames} frames"
        share = 100 * wrong / sure
        print(f"{method}, {TAKE.what}: {frames} frames, sure {100 * sure / pixels:.1f} % of the pixels of the strip, "
              f"of these wrong by more than {WRONG_PX} px {share:.2f} % (too near {100 * near / sure:.2f} %)")
        assert share <= MOST, f"{method}: {share:.2f} percent of the sure pixels are wrong, {MOST} are allowed"


if __name__ == "__main__":
    main()
