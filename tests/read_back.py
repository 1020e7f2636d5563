#!/usr/bin/env python3
"""What the tool writes, as numpy, OpenCV and trimesh read it: the same metres in all of them.

Needs numpy, opencv-python-headless and trimesh. Usage: read_back.py HAARLINE"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
import trimesh

FOCAL_PX, BASELINE_MM = 280.0, 60.0  # Those of the rendered room.
FARTHEST_M = 3.0


def run(*arguments, cwd):
    return subprocess.run([haarline, *arguments], cwd=cwd, check=True, capture_output=True, text=True).stdout


def check(what, ok):
    print(f"{what}: {'ok' if ok else 'WRONG'}")
    assert ok, what


def read_back(folder, name):
    """Everything that was written of one map, against its PFM."""
    disparity = cv2.imread(str(folder / f"{name}.pfm"), cv2.IMREAD_UNCHANGED)
    known = np.isfinite(disparity)
    check(f"{name}: some pixels are known, some are not", 0.3 < known.mean() < 1)

    npy = np.load(folder / f"{name}.npy")
    check(f"{name}.npy is float32, NaN where unknown, else the same",
          npy.dtype == np.float32 and np.array_equal(np.isnan(npy), ~known) and np.array_equal(npy[known], disparity[known]))

    kitti = cv2.imread(str(folder / f"{name}.png"), cv2.IMREAD_UNCHANGED)
    check(f"{name}.png is disparity x 256",
          kitti.dtype == np.uint16 and np.array_equal(kitti, np.where(known, np.maximum(np.where(known, disparity, 0) * 256, 1), 0)))

    finite = known & (disparity > 0)
    wanted_m = np.full(disparity.shape, np.inf)
    wanted_m[finite] = FOCAL_PX * BASELINE_MM / 1000 / disparity[finite]
    near = finite & (wanted_m <= FARTHEST_M)
    check(f"{name}: some points are farther than {FARTHEST_M} m", 0 < near.sum() < finite.sum())

    depth = cv2.imread(str(folder / f"{name}_depth.png"), cv2.IMREAD_UNCHANGED)
    check(f"{name}_depth.png has 16 bits", depth.dtype == np.uint16 and depth.shape == disparity.shape)
    edge = np.abs(wanted_m - FARTHEST_M) < 0.001  # Rounding to mm decides there.
    check(f"{name}_depth.png is 0 where unknown or too far", np.array_equal((depth > 0)[~edge], near[~edge]))
    both = near & (depth > 0)
    off = np.abs(depth[both] / 1000 - wanted_m[both])
    check(f"{name}_depth.png is in mm: off by {off.max() * 1000:.2f} mm at most", off.max() <= 0.001)

    cloud = trimesh.load(folder / f"{name}.ply")
    check(f"{name}.ply has the same points", abs(len(cloud.vertices) - near.sum()) <= edge.sum())
    height, width = disparity.shape
    y, x = np.nonzero(near)
    z = wanted_m[near]
    wanted = np.stack([(x - (width - 1) / 2) * z / FOCAL_PX, (y - (height - 1) / 2) * z / FOCAL_PX, z], axis=1)
    if len(wanted) == len(cloud.vertices):
        off = np.abs(cloud.vertices - wanted).max()
        check(f"{name}.ply is in m: off by {off * 1000:.3f} mm at most", off < 1e-3)
    left = cv2.imread(str(folder / "left.png"), cv2.IMREAD_GRAYSCALE)
    colours = np.asarray(cloud.visual.vertices if hasattr(cloud.visual, "vertices") else cloud.colors)[:, :3]
    if len(colours) == near.sum():
        check(f"{name}.ply has the left view's grey levels", np.array_equal(colours, np.repeat(left[near][:, None], 3, 1)))


haarline = str(Path(sys.argv[1]).resolve())
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    run("demo", "-o", ".", cwd=folder)
    search = str(json.loads((folder / "meta.json").read_text())["num_disparities"])
    depths = ["--num-disparities", search, "--focal-px", str(FOCAL_PX), "--baseline-mm", str(BASELINE_MM),
              "--max-depth", str(FARTHEST_M)]
    files = [part for ending in ("pfm", "npy", "png", "ply") for part in ("-o", f"map.{ending}")]
    run("depth", "left.png", "right.png", *depths, *files, "--depth-png", "map_depth.png", cwd=folder)
    read_back(folder, "map")

    for side in ("left", "right"):
        (folder / "take" / side).mkdir(parents=True)
        (folder / "take" / side / "7.png").write_bytes((folder / f"{side}.png").read_bytes())
    run("play", "take", "-o", ".", *depths, "--write", "disparity,npy,kitti,depth,ply", cwd=folder)
    read_back(folder, "7")
