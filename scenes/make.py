#!/usr/bin/env python3
"""Makes the 36 scenes that all accuracy figures are measured on, out of your own downloads.

    scenes/make.py DOWNLOADS -o SCENES [--only teddy,cones]

DOWNLOADS is a folder in which the archives of Middlebury, KITTI 2015 and ETH3D lie unpacked (see README.md beside this
script). What is made is compared with checksums of the scenes that our figures are from: status 0 if all that could be
made is equal, 1 if something differs, 2 if nothing could be made.

Needs numpy and opencv-python-headless.
"""
import argparse
import hashlib
import json
import re
import sys
from pathlib import Path

import cv2
import numpy as np

WIDTH = 320
CHECKSUMS = Path(__file__).with_name("checksums.json")
UNKNOWN, HIDDEN, SEEN = 0, 128, 255  # in nonocc.png

MIDDLEBURY_2001 = ["barn1", "sawtooth", "venus"]
MIDDLEBURY_2003 = ["cones", "teddy"]
MIDDLEBURY_2006 = "Aloe Baby1 Books Bowling1 Cloth2 Dolls Lampshade1 Laundry Moebius Rocks1 Wood1".split()
MIDDLEBURY_V3 = "Adirondack Motorcycle MotorcycleE Piano PianoL Playroom Recycle Vintage".split()
KITTI = "000001 000002 000003 000004 000005 000006 000010 000018 000019 000020".split()


class Missing(Exception):
    """A file that is not in the downloads."""


class Downloads:
    """Files by the end of their path, wherever the archives were unpacked."""

    def __init__(self, root):
        self.files = sorted(path for path in root.rglob("*") if path.is_file())

    def find(self, *ends):
        """The file whose path ends in one of `ends`, the first of them that there is."""
        for end in ends:
            for path in self.files:
                if ("/" + path.as_posix()).endswith("/" + end):
                    return path
        raise Missing(ends[0])


def read_grey(path):
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        sys.exit(f"{path}: is no image that can be read")
    # Rec. 601, in the integers of OpenCV.
    return image if image.ndim == 2 else cv2.cvtColor(image[:, :, :3], cv2.COLOR_BGR2GRAY)


def read_scaled(path, scale):
    """A disparity image that holds the disparity times `scale`; px, 0 = unknown."""
    return read_grey(path).astype(np.float64) / scale


def read_pfm(path):
    """px; what is not finite is unknown, 0."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"Pf":
            sys.exit(f"{path}: is no PFM file of one channel")
        width, height = map(int, file.readline().split())
        kind = "<f4" if float(file.readline()) < 0 else ">f4"
        map_ = np.frombuffer(file.read(), kind).reshape(height, width)[::-1]
    return np.where(np.isfinite(map_), map_, 0).astype(np.float64)


def read_calibration(path):
    """Focal length, px, and baseline, mm."""
    text = path.read_text()
    focal = re.search(r"^cam0=\[([\d.]+)", text, re.M)
    baseline = re.search(r"^baseline=([\d.]+)", text, re.M)
    if not focal or not baseline:
        sys.exit(f"{path}: has no cam0 or no baseline")
    return float(focal[1]), float(baseline[1])


def mask_from_right(left, right):
    """Where the right truth, at most one column beside, tells the left one's disparity to 1 px."""
    height, width = left.shape
    y, x = np.indices(left.shape)
    at = np.rint(x - left).astype(int)
    seen = np.zeros(left.shape, bool)
    for beside in (-1, 0, 1):
        inside = (at + beside >= 0) & (at + beside < width)
        other = right[y, np.clip(at + beside, 0, width - 1)]
        seen |= inside & (other > 0) & (np.abs(other - left) <= 1)
    return np.where(left <= 0, UNKNOWN, np.where(seen, SEEN, HIDDEN)).astype(np.uint8)


def middlebury_2001_2003(downloads, name, scale):
    view = lambda n: read_grey(downloads.find(f"{name}/im{n}.ppm", f"{name}/im{n}.png"))
    truth = lambda n: read_scaled(downloads.find(f"{name}/disp{n}.pgm", f"{name}/disp{n}.png"), scale)
    return {"views": (view(2), view(6)), "truth": truth(2), "mask": mask_from_right(truth(2), truth(6))}


def tsukuba(downloads):
    view = lambda n: read_grey(downloads.find(f"tsukuba/scene1.row3.col{n}.ppm"))
    truth = read_scaled(downloads.find("tsukuba/truedisp.row3.col3.pgm"), 16)
    return {"views": (view(3), view(4)), "truth": truth, "mask": read_grey(downloads.find("tsukuba/nonocc.png"))}


def middlebury_2006(downloads, name):
    view = lambda n: read_grey(downloads.find(f"{name}/view{n}.png"))
    truth = lambda n: read_scaled(downloads.find(f"{name}/disp{n}.png"), 3)
    mask = mask_from_right(truth(1), truth(5))
    return {"views": (view(1), view(5)), "truth": truth(1), "mask": mask, "focal": 3740 / 3, "baseline": 160}


def middlebury_v3(downloads, name):
    file = lambda end: downloads.find(f"trainingQ/{name}/{end}")
    focal, baseline = read_calibration(file("calib.txt"))
    views = read_grey(file("im0.png")), read_grey(file("im1.png"))
    truth, mask = read_pfm(file("disp0GT.pfm")), read_grey(file("mask0nocc.png"))
    return {"views": views, "truth": truth, "mask": mask, "focal": focal, "baseline": baseline}


def kitti(downloads, number):
    view = lambda n: read_grey(downloads.find(f"training/image_{n}/{number}_10.png"))
    truth = read_scaled(downloads.find(f"training/disp_noc_0/{number}_10.png"), 256)
    mask = np.where(truth > 0, SEEN, UNKNOWN).astype(np.uint8)
    return {"views": (view(2), view(3)), "truth": truth, "mask": mask, "focal": 721.54, "baseline": 540}


def eth3d(downloads, name):
    file = lambda end: downloads.find(f"{name}/{end}")
    focal, baseline = read_calibration(file("calib.txt"))
    views = read_grey(file("im0.png")), read_grey(file("im1.png"))
    truth, mask = read_pfm(file("disp0GT.pfm")), read_grey(file("mask0nocc.png"))
    return {"views": views, "truth": truth, "mask": mask, "focal": focal, "baseline": baseline}


def recipes():
    """Name, family and reader of every scene."""
    found = {name: ("midd0106", lambda d, n=name: middlebury_2001_2003(d, n, 8)) for name in MIDDLEBURY_2001}
    found |= {name: ("midd0106", lambda d, n=name: middlebury_2001_2003(d, n, 4)) for name in MIDDLEBURY_2003}
    found |= {name.lower(): ("midd0106", lambda d, n=name: middlebury_2006(d, n)) for name in MIDDLEBURY_2006}
    found["tsukuba"] = ("midd0106", tsukuba)
    found |= {f"v3q_{name.lower()}": ("v3", lambda d, n=name: middlebury_v3(d, n)) for name in MIDDLEBURY_V3}
    found |= {f"kitti15_{number}": ("kitti15", lambda d, n=number: kitti(d, n)) for number in KITTI}
    found["eth3d_terrace_2s"] = ("eth3d", lambda d: eth3d(d, "terrace_2s"))
    return dict(sorted(found.items()))


def reduce(scene):
    """The scene at 320 px width: views by the mean over areas, truth and mask by the nearest pixel."""
    height, width = scene["truth"].shape
    factor = WIDTH / width
    size = (WIDTH, round(height * factor))
    rows, columns = (np.floor((np.arange(count) + 0.5) / factor).astype(int) for count in reversed(size))
    nearest = lambda image: image[np.minimum(rows, height - 1)][:, np.minimum(columns, width - 1)]
    # Through the 16 bits that a scene's truth has at its own size.
    truth = np.rint(np.rint(nearest(scene["truth"]) * 256) * factor).astype(np.uint16)
    left, right = (cv2.resize(view, size, interpolation=cv2.INTER_AREA) for view in scene["views"])
    return {"left": left, "right": right, "truth": truth, "nonocc": nearest(scene["mask"])}


def describe(images, scene, name, family):
    """What meta.json holds."""
    truth = images["truth"]
    most = np.percentile(truth[truth > 0] / 256, 99.9)
    meta = {"name": name, "family": family, "num_disparities": max(16, 16 * int(np.ceil((most + 1) / 16)))}
    if "focal" in scene:
        meta |= {"focal_px": scene["focal"] * WIDTH / scene["truth"].shape[1], "baseline_mm": scene["baseline"]}
    return meta


def checksums(images, meta):
    """SHA-256 of each picture as a binary PGM, so that it does not depend on who packed the PNG; and what is searched."""
    found = {"num_disparities": meta["num_disparities"]}
    for name, image in images.items():
        most = 65535 if image.dtype == np.uint16 else 255
        header = f"P5\n{image.shape[1]} {image.shape[0]}\n{most}\n".encode()
        found[f"{name}.png"] = hashlib.sha256(header + image.astype(image.dtype.newbyteorder(">")).tobytes()).hexdigest()
    return found


def read_finished(folder):
    """The checksums of a scene that is there already."""
    images = {n: cv2.imread(str(folder / f"{n}.png"), cv2.IMREAD_UNCHANGED) for n in ("left", "right", "truth", "nonocc")}
    return checksums(images, json.loads((folder / "meta.json").read_text()))


def write(folder, images, meta):
    folder.mkdir(parents=True, exist_ok=True)
    for name, image in images.items():
        cv2.imwrite(str(folder / f"{name}.png"), image)
    (folder / "meta.json").write_text(json.dumps(meta, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("downloads", type=Path, metavar="DOWNLOADS")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="SCENES")
    parser.add_argument("--only", help="these scenes, separated by commas")
    arguments = parser.parse_args()
    if not arguments.downloads.is_dir():
        parser.error(f"{arguments.downloads}: no such folder")
    if arguments.output.resolve() == arguments.downloads.resolve():
        parser.error("-o: must not be the folder of the downloads")
    wanted = recipes()
    if arguments.only:
        unknown = set(arguments.only.split(",")) - set(wanted)
        if unknown:
            parser.error(f"--only: there is no scene {', '.join(sorted(unknown))}, but {', '.join(wanted)}")
        wanted = {name: wanted[name] for name in arguments.only.split(",")}
    known, downloads = json.loads(CHECKSUMS.read_text()), Downloads(arguments.downloads)
    equal, different, missing = [], [], []
    for name, (family, read) in wanted.items():
        try:
            scene = read(downloads)
        except Missing as file:
            missing.append(f"{name} ({file})")
            continue
        images = reduce(scene)
        meta = describe(images, scene, name, family)
        write(arguments.output / name, images, meta)
        found = checksums(images, meta)
        off = [file for file in known[name] if known[name][file] != found[file]]
        (different if off else equal).append(name)
        print(f"{name}: " + (f"NOT EQUAL: {', '.join(off)}" if off else "equal"))
    print(f"{len(equal)} equal, {len(different)} not equal, {len(missing)} not in {arguments.downloads}")
    if missing:
        print("not found: " + "; ".join(missing))
    sys.exit(1 if different else 0 if equal else 2)


if __name__ == "__main__":
    main()
