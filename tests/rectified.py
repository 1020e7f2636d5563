#!/usr/bin/env python3
"""Holds our rectification of chessboard pairs against OpenCV's: how far the rows of the corners are apart, and how far the
grey levels are from cv2.remap's into the same views (numpy, OpenCV).

    python3 tests/rectified.py HAARLINE DATA      (DATA: the folder with the rigs, rigs/stereopi_320x240)
"""
import glob
import os
import subprocess
import sys
import tempfile
import tomllib

import cv2
import numpy as np

BOARD = (9, 6)
MOST_ROW_ERROR, MOST_GREY = 0.15, 1.0


def corners(view):
    found, corners = cv2.findChessboardCorners(view, BOARD)
    if not found:
        return None
    return cv2.cornerSubPix(view, corners, (5, 5), (-1, -1), (3, 50, 0.01)).reshape(-1, 2)


def row_errors(pairs):
    """Distances of the corners' rows, px, of the pairs in which both views show all of them."""
    errors = []
    for left, right in pairs:
        found = [corners(left), corners(right)]
        if all(points is not None for points in found):
            errors.append(np.abs(found[0][:, 1] - found[1][:, 1]))
    return np.concatenate(errors), len(errors)


def opencv_maps(rig, side):
    """Where a camera saw the pixels of its rectified view, by OpenCV from the same description."""
    fx, fy, cx, cy = rig[f"{side}_camera"]
    camera = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    shift = rig.get("doffs", 0) if side == "right" else 0
    view = np.array([[rig["focal_px"], 0, rig["cx"] + shift], [0, rig["focal_px"], rig["cy"]], [0, 0, 1]])
    turn = cv2.Rodrigues(np.array(rig[f"{side}_turn"]))[0]
    size = (rig["width"], rig["height"])
    return cv2.initUndistortRectifyMap(camera, np.array(rig[f"{side}_lens"]), turn, view, size, cv2.CV_32FC1)


def main(haarline, data):
    folder = os.path.join(data, "rigs", "stereopi_320x240")
    with tempfile.TemporaryDirectory() as work:
        rig_file, out = os.path.join(work, "rig.toml"), os.path.join(work, "rectified")
        subprocess.run([haarline, "rig", "import", os.path.join(folder, "calibration.json"), "-o", rig_file], check=True)
        subprocess.run([haarline, "rig", "rectify", os.path.join(folder, "calib"), "--layout", "names", "--rig", rig_file, "-o", out], check=True)
        with open(rig_file, "rb") as file:
            rig = tomllib.load(file)
        raw, ours, theirs, grey = [], [], [], []
        maps = {side: opencv_maps(rig, side) for side in ("left", "right")}
        for left in sorted(glob.glob(os.path.join(out, "left", "*.png"))):
            number = os.path.basename(left).removesuffix(".png").rsplit("_", 1)[-1]
            views = [[], [], []]
            for side in ("left", "right"):
                view = cv2.imread(os.path.join(folder, "calib", f"{side}_{number}.png"), cv2.IMREAD_GRAYSCALE)
                made = cv2.imread(left.replace(f"{os.sep}left{os.sep}", f"{os.sep}{side}{os.sep}"), cv2.IMREAD_GRAYSCALE)
                wanted = cv2.remap(view, *maps[side], cv2.INTER_LINEAR)
                across, down = maps[side]
                seen = (across >= 0) & (across <= rig["width"] - 1) & (down >= 0) & (down <= rig["height"] - 1)
                grey.append(np.abs(made.astype(float) - wanted)[seen])
                for kind, image in zip(views, (view, made, wanted)):
                    kind.append(image)
            raw.append(views[0])
            ours.append(views[1])
            theirs.append(views[2])
        grey = np.concatenate(grey).mean()
        print(f"grey levels: {grey:.3f} from cv2.remap's in the mean")
        for name, pairs in (("as they came", raw), ("by OpenCV", theirs), ("by us", ours)):
            errors, count = row_errors(pairs)
            print(f"rows of corners {name}: {errors.mean():.3f} px apart in the mean, {np.quantile(errors, 0.95):.3f} px at most in 95 % ({count} pairs)")
        assert errors.mean() <= MOST_ROW_ERROR, errors.mean()
        assert grey <= MOST_GREY, grey


if __name__ == "__main__":
    main(*sys.argv[1:])
