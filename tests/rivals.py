#!/usr/bin/env python3
"""Scores our methods and OpenCV's StereoSGBM (and ELAS), raw and with the same gifts, in every condition, by one scorer.

    tests/rivals.py HAARLINE SCENES [--docs docs/rivals.md] [--json FILE] [--conditions clean,"noise 10"]

The gifts are those that we give ourselves: the front end's smoothing by the noise (`eval --smooth`) before, the
filling of holes (`eval --fill`) after. `full` and `lite` smooth already, so they get the filling only. OpenCV sees the
views that our methods see (`eval --write-views`), and its maps are scored by `eval --maps`. With --docs the tables
between the marks in that file are replaced.

Needs numpy and opencv-python-headless. With pyelas, the Python binding of libelas, ELAS is one more row; to build it,
pip install wheel; CFLAGS=-I$(python3 -c 'import numpy; print(numpy.get_include())') pip install --no-build-isolation pyelas
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

try:
    from elas import Elas
except ImportError:
    Elas = None

CONDITIONS = {
    "clean": [],
    "noise 5": ["--noise", "5"],
    "noise 10": ["--noise", "10"],
    "noise 20": ["--noise", "20"],
    "right x 0.8": ["--gain", "0.8"],
    "right x 1.2": ["--gain", "1.2"],
    "right + 25": ["--offset", "25"],
    "low light": ["--both-gain", "0.25", "--noise", "2"],
}
OURS = ["full", "lite", "block", "sgm"]
SMOOTH_THEMSELVES = {"full", "lite"}
FIGURES = {
    "tot05": "off by more than half a pixel, or not answered",
    "tot1": "off by more than 1 px, or not answered",
    "tot2": "off by more than 2 px, or not answered",
    "off10": "off by more than a tenth of the depth, or not answered",
}
BEGIN, END = "<!-- tests/rivals.py: begin -->", "<!-- tests/rivals.py: end -->"


def sgbm(num_disparities, mode, uniqueness):
    """The parameters of the samples of OpenCV for 5x5 px."""
    return cv2.StereoSGBM_create(
        minDisparity=0, numDisparities=num_disparities, blockSize=5, P1=200, P2=800, disp12MaxDiff=1,
        preFilterCap=63, uniquenessRatio=uniqueness, speckleWindowSize=100, speckleRange=2, mode=mode,
    )  # fmt: skip


def opencv(mode, uniqueness):
    return lambda num_disparities, left, right: sgbm(num_disparities, mode, uniqueness).compute(left, right) / 16.0


def elas(num_disparities, left, right):
    """With its own default parameters, those for robotics."""
    method = Elas()
    method.disp_max = num_disparities - 1
    return method.process(left, right)[0]


# Disparities in px; what is negative is unknown.
RIVALS = {
    "SGBM": opencv(cv2.STEREO_SGBM_MODE_SGBM, 10),
    "SGBM_3WAY": opencv(cv2.STEREO_SGBM_MODE_SGBM_3WAY, 0),
    "SGBM_HH": opencv(cv2.STEREO_SGBM_MODE_HH, 0),
}
if Elas:
    RIVALS["ELAS"] = elas


def write_pfm(path, disparity):
    height, width = disparity.shape
    with open(path, "wb") as file:
        file.write(f"Pf\n{width} {height}\n-1.0\n".encode())
        file.write(disparity[::-1].astype("<f4").tobytes())


def match(method, scenes, views, maps):
    """A rival's maps of the views in `views`."""
    maps.mkdir()
    for folder in sorted(views.iterdir()):
        meta = json.loads((scenes / folder.name / "meta.json").read_text())
        left, right = (cv2.imread(str(folder / f"{side}.png"), cv2.IMREAD_GRAYSCALE) for side in ("left", "right"))
        disparity = method(meta["num_disparities"], left, right)
        write_pfm(maps / f"{folder.name}.pfm", np.where(disparity < 0, np.inf, disparity))


class Scorer:
    def __init__(self, haarline, scenes):
        self.haarline, self.scenes = haarline, scenes

    def mean(self, options):
        command = [self.haarline, "eval", self.scenes, "--json", "-", *map(str, options)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
        return json.loads(done.stdout)["mean"]


def try_condition(scorer, options, work):
    """Every method's mean scores: {method: {"raw": ..., "gifts": ...}}."""
    found = {}
    raw, smooth = work / "raw", work / "smooth"
    for method in OURS:
        plain = ["--method", method, *options]
        found[method] = {
            "raw": scorer.mean(plain + (["--write-views", raw] if method == "block" else [])),
            "gifts": scorer.mean(
                plain + ["--fill"]
                + ([] if method in SMOOTH_THEMSELVES else ["--smooth"])
                + (["--write-views", smooth] if method == "block" else [])
            ),
        }  # fmt: skip
    for method, run in RIVALS.items():
        match(run, scorer.scenes, raw, work / f"{method}-raw")
        match(run, scorer.scenes, smooth, work / f"{method}-smooth")
        found[method] = {
            "raw": scorer.mean(["--maps", work / f"{method}-raw", *options]),
            "gifts": scorer.mean(["--maps", work / f"{method}-smooth", "--fill", *options]),
        }
    return found


def tables(found, scenes):
    """Markdown: a table for each figure, raw / with gifts."""
    lines = [
        f"Means over {scenes} scenes in percent, less is better: raw / with the gifts (our smoothing before, our filling",
        f"after; `full` and `lite` smooth already). OpenCV {cv2.__version__}; `SGBM_3WAY` and `SGBM_HH` without",
        "uniqueness test" + (", ELAS with its default parameters" if Elas else "") + ". Made by `tests/rivals.py`.",
    ]
    conditions = list(found)
    cell = {"density": "{:.1f}"}
    for figure, words in {**FIGURES, "density": "answered"}.items():
        lines += ["", f"**{figure}** ({words}):", "", "| | " + " | ".join(conditions) + " |"]
        lines.append("|---" * (len(conditions) + 1) + "|")
        for method in [*OURS, *RIVALS]:
            write = cell.get(figure, "{:.2f}").format
            values = [found[condition][method] for condition in conditions]
            cells = [f"{write(v['raw'][figure])} / {write(v['gifts'][figure])}" for v in values]
            name = f"`{method}`" if method in OURS else method
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def replace(path, text):
    page = path.read_text()
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        sys.exit(f"{path}: the marks {BEGIN} and {END} are missing")
    before, rest = page.split(BEGIN)
    path.write_text(f"{before}{BEGIN}\n{text}{END}{rest.split(END)[1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("haarline")
    parser.add_argument("scenes", type=Path)
    parser.add_argument("--docs", type=Path, help="a page whose tables between the marks are replaced")
    parser.add_argument("--json", type=Path, help="all means")
    parser.add_argument("--conditions", default=",".join(CONDITIONS), help="only these")
    arguments = parser.parse_args()
    unknown = set(arguments.conditions.split(",")) - set(CONDITIONS)
    if unknown:
        sys.exit(f"--conditions: there is no {', '.join(sorted(unknown))}, but {', '.join(CONDITIONS)}")
    cv2.setNumThreads(1)
    scorer, found = Scorer(arguments.haarline, arguments.scenes), {}
    for condition in arguments.conditions.split(","):
        with tempfile.TemporaryDirectory() as work:
            found[condition] = try_condition(scorer, CONDITIONS[condition], Path(work))
            scenes = len(list((Path(work) / "raw").iterdir()))
        print(f"{condition}: done", file=sys.stderr)
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n")
    text = tables(found, scenes)
    print(text)
    if arguments.docs:
        replace(arguments.docs, text)


if __name__ == "__main__":
    main()
