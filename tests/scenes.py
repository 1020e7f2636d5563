#!/usr/bin/env python3
"""Tries scenes/make.py: seven scenes laid out as the sites ship them, from their native size in DATA/native.

    tests/scenes.py DATA

All pictures must be those of the checksums. The sites' right truths of teddy and cones are not in DATA: their masks, which
follow from these, are made up here and not compared; the rule is tried on a small case instead. Colours are not in DATA
either: views are laid out grey.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import json
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scenes"))
sys.dont_write_bytecode = True
import make  # noqa: E402


def read(scene, name):
    return cv2.imread(str(scene / name), cv2.IMREAD_UNCHANGED)


def write(path, image):
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), image)


def write_pfm(path, truth):
    height, width = truth.shape
    px = np.where(truth == 0, np.inf, truth / 256)[::-1].astype("<f4")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(f"Pf\n{width} {height}\n-0.003922\n".encode() + px.tobytes())


def write_calibration(path, scene):
    meta = json.loads((scene / "meta.json").read_text())
    focal = meta["focal_px"]
    path.write_text(f"cam0=[{focal} 0 155; 0 {focal} 124; 0 0 1]\nbaseline={meta['baseline_mm']}\nwidth=9\n")


def colour(image):
    return cv2.merge([image] * 3)


def lay_out(native, root):
    """As the archives unpack."""
    for name in ("teddy", "cones"):
        scene, folder = native / name, root / "middlebury/2003" / name
        write(folder / "im2.ppm", colour(read(scene, "left.png")))
        write(folder / "im6.ppm", colour(read(scene, "right.png")))
        truth = read(scene, "truth.png") // 64
        write(folder / "disp2.pgm", truth.astype(np.uint8))
        write(folder / "disp6.pgm", truth.astype(np.uint8))  # not the site's, see above
    scene, folder = native / "tsukuba", root / "middlebury/2001/tsukuba"
    write(folder / "scene1.row3.col3.ppm", colour(read(scene, "left.png")))
    write(folder / "scene1.row3.col4.ppm", colour(read(scene, "right.png")))
    write(folder / "truedisp.row3.col3.pgm", (read(scene, "truth.png") // 16).astype(np.uint8))
    write(folder / "nonocc.png", read(scene, "nonocc.png"))
    for name, folder in [
        ("v3q_motorcycle", root / "MiddEval3/trainingQ/Motorcycle"),
        ("v3q_playroom", root / "MiddEval3/trainingQ/Playroom"),
        ("eth3d_terrace_2s", root / "two_view_training/terrace_2s"),
    ]:
        scene = native / name
        write(folder / "im0.png", colour(read(scene, "left.png")))
        write(folder / "im1.png", colour(read(scene, "right.png")))
        write(folder / "mask0nocc.png", read(scene, "nonocc.png"))
        write_pfm(folder / "disp0GT.pfm", read(scene, "truth.png"))
        write_calibration(folder / "calib.txt", scene)
    scene, folder = native / "kitti15_000010", root / "data_scene_flow/training"
    write(folder / "image_2/000010_10.png", colour(read(scene, "left.png")))
    write(folder / "image_3/000010_10.png", colour(read(scene, "right.png")))
    write(folder / "disp_noc_0/000010_10.png", read(scene, "truth.png"))


def try_mask():
    """A near strip of 3 px at 4 px before a back at 2 px: what it hides, and what leaves the view."""
    left = np.full((1, 16), 2.0)
    left[0, 8:11] = 4
    right = np.full((1, 16), 2.0)
    right[0, 4:7] = 4
    left[0, 15] = 0
    mask = make.mask_from_right(left, right)[0]
    # Columns 6 and 7 lie behind the strip in the right view; the first of them has the back one column beside, as
    # column 1, of which the first column of the right view is beside, is seen.
    assert mask.tolist() == [128, 255, 255, 255, 255, 255, 255, 128, 255, 255, 255, 255, 255, 255, 255, 0], mask


def main():
    data = Path(sys.argv[1])
    try_mask()
    scenes = "teddy cones tsukuba v3q_motorcycle v3q_playroom eth3d_terrace_2s kitti15_000010".split()
    with tempfile.TemporaryDirectory() as work:
        downloads, output = Path(work) / "downloads", Path(work) / "scenes"
        lay_out(data / "native", downloads)
        command = [sys.executable, ROOT / "scenes/make.py", downloads, "-o", output]
        done = subprocess.run(command, capture_output=True, text=True)
        print(done.stdout, done.stderr)
        known = json.loads(make.CHECKSUMS.read_text())
        assert sorted(path.name for path in output.iterdir()) == sorted(scenes)
        for name in scenes:
            found = make.read_finished(output / name)
            off = {file for file in found if found[file] != known[name][file]}
            assert off <= ({"nonocc.png"} if name in ("teddy", "cones") else set()), (name, off)
            mine, theirs = (json.loads((folder / name / "meta.json").read_text()) for folder in (output, data / "qvga"))
            for key, value in mine.items():
                same = abs(value - theirs[key]) < 1e-6 * abs(value) if isinstance(value, float) else value == theirs[key]
                assert same, (name, key, value, theirs[key])
        assert "5 equal, 2 not equal, 29 not in" in done.stdout and done.returncode == 1
        # A changed pixel is noticed.
        left = downloads / "data_scene_flow/training/image_2/000010_10.png"
        image = cv2.imread(str(left), cv2.IMREAD_UNCHANGED)
        image[100:104, 100:104] ^= 0x40
        cv2.imwrite(str(left), image)
        done = subprocess.run([*command, "--only", "kitti15_000010"], capture_output=True, text=True)
        assert done.returncode == 1 and "NOT EQUAL: left.png" in done.stdout, done.stdout
        nothing = subprocess.run([*command, "--only", "wood1"], capture_output=True, text=True)
        assert nothing.returncode == 2 and "wood1 (Wood1/disp1.png)" in nothing.stdout, nothing.stdout
    print("seven scenes made of the sites' layouts are those of the checksums")


if __name__ == "__main__":
    main()
