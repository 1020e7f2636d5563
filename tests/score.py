#!/usr/bin/env python3
"""Scores maps of `haarline eval` a second time, from the files alone, and holds every column against the tool's.

    tests/score.py HAARLINE SCENES [OPTION OF EVAL ...]

Needs numpy and opencv-python-headless. Ends with status 1 where a figure differs by more than 0.01.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

TOLERANCE = 0.01
CURVE = 20_000  # points of the sparsification curve


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"Pf\n"
        width, height = map(int, file.readline().split())
        kind = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.frombuffer(file.read(), kind).reshape(height, width)[::-1].astype(np.float64)


def share(mask, of):
    return 100.0 * np.count_nonzero(mask) / of if of else None


def bad_among_best(confidence, bad, counts):
    """Percent bad among the `counts` most confident answers; within equal confidence the expected share."""
    levels, group = np.unique(-confidence.astype(int), return_inverse=True)
    sizes = np.bincount(group, minlength=len(levels))
    bads = np.bincount(group, weights=bad, minlength=len(levels))
    kept = np.concatenate([[0], np.cumsum(sizes)])
    lost = np.concatenate([[0], np.cumsum(bads)])
    return 100.0 * np.interp(counts, kept, lost) / counts


def figures(error, true, confidence, reference):
    """The figures of a set of pixels; `error` is NaN where there is no answer."""
    count, known = len(error), ~np.isnan(error)
    wrong = lambda limit: ~(error <= limit)  # unanswered counts as wrong
    answered = np.count_nonzero(known)
    bad2 = error[known] > 2
    among = lambda counts: bad_among_best(confidence[known], bad2, counts)
    return {
        "density": share(known, count),
        "bad1": share(error[known] > 1, answered),
        "bad2": share(bad2, answered),
        "tot05": share(wrong(0.5), count),
        "tot1": share(wrong(1), count),
        "tot2": share(wrong(2), count),
        "off10": share(wrong(true / 10), count),
        "epe": error[known].mean() if answered else None,
        "bad2_at_bm_density": among(min(reference / 100 * count, answered)) if reference and answered else None,
        "auc": among((np.arange(CURVE) + 0.5) / CURVE * answered).mean() if answered else None,
    }


def classes(error, confidence):
    found = []
    for first in range(0, 256, 16):
        inside = ~np.isnan(error) & (confidence >= first) & (confidence < first + 16)
        size = np.count_nonzero(inside)
        found.append({"pixels": share(inside, len(error)), "wrong": share(error[inside] > 2, size)})
    return found


def score(scene, maps, reference):
    read = lambda name: cv2.imread(str(scene / name), cv2.IMREAD_UNCHANGED)
    true = read("truth.png").astype(np.float64) / 256
    first = json.loads((scene / "meta.json").read_text())["num_disparities"]
    disparity = read_pfm(maps / f"{scene.name}.pfm")
    confidence = cv2.imread(str(maps / f"{scene.name}_confidence.png"), cv2.IMREAD_UNCHANGED)
    error = np.where(np.isfinite(disparity), np.abs(np.where(np.isfinite(disparity), disparity, 0) - true), np.nan)
    seen, reached = read("nonocc.png") == 255, np.arange(true.shape[1]) >= first
    regions = {"": seen & reached, "occluded": ~seen, "left_band": seen & ~reached}
    result = {}
    for region, mask in regions.items():
        mask &= true > 0
        if not mask.any():
            result[region] = None
            continue
        e, t, c = error[mask], true[mask], confidence[mask]
        reference_here = None if region else reference
        result[region] = figures(e, t, c, reference_here)
        result[region]["default_answers"] = figures(np.where(c >= 16, e, np.nan), t, c, reference_here)
        result[region]["confidence_classes"] = classes(e, c)
    return {**result.pop(""), **result}


def mean(scores):
    """Of each figure over the scenes that have it; of confidence classes, scenes weigh alike."""
    scores = [score for score in scores if score is not None]
    if not scores:
        return None
    result = {}
    for key, first in scores[0].items():
        values = [score[key] for score in scores]
        if key == "confidence_classes":
            result[key] = []
            for column in zip(*values):
                pixels = sum(c["pixels"] for c in column)
                wrong = sum(c["pixels"] * c["wrong"] for c in column if c["wrong"] is not None)
                result[key].append({"pixels": pixels / len(column), "wrong": wrong / pixels if pixels else None})
        elif isinstance(first, dict) or key in ("occluded", "left_band", "default_answers"):
            result[key] = mean(values)
        else:
            values = [value for value in values if value is not None]
            result[key] = sum(values) / len(values) if values else None
    return result


class Comparison:
    def __init__(self):
        self.figures, self.worst, self.different = 0, 0.0, []

    def compare(self, mine, tools, where):
        if isinstance(mine, dict):
            for key, value in mine.items():
                # A region without a pixel is left out of a mean.
                self.compare(value, tools.get(key), f"{where} {key}")
        elif isinstance(mine, list):
            for index, (a, b) in enumerate(zip(mine, tools, strict=True)):
                self.compare(a, b, f"{where} {index}")
        else:
            self.figures += 1
            off = 0.0 if mine is tools else float("inf") if mine is None or tools is None else abs(mine - tools)
            self.worst = max(self.worst, off)
            if off > TOLERANCE:
                self.different.append(f"{where}: {tools} of the tool, {mine} here")


def main():
    haarline, folder, options = sys.argv[1], Path(sys.argv[2]), sys.argv[3:]
    with tempfile.TemporaryDirectory() as work:
        maps = Path(work)
        command = [haarline, "eval", folder, "--occluded", "--left-band", "--json", "-", "-o", maps, *options]
        report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        references = (report["baselines"] or {"methods": {}})["methods"].get("bm9", {"scenes": {}})["scenes"]
        density = lambda name: references.get(name, {}).get("density")
        scores = {name: score(folder / name, maps, density(name)) for name in report["scenes"]}
    comparison = Comparison()
    for name, mine in scores.items():
        comparison.compare(mine, report["scenes"][name], name)
    for family in report["families"]:
        inside = [mine for name, mine in scores.items() if report["scenes"][name]["family"] == family]
        comparison.compare(mean(inside), report["families"][family], f"family {family}")
    comparison.compare(mean(list(scores.values())), report["mean"], "mean")
    print(f"{len(scores)} scenes, {comparison.figures} figures, greatest difference {comparison.worst:.5f}")
    print("\n".join(comparison.different[:20]))
    assert len(scores) > 0 and comparison.figures > 100
    sys.exit(1 if comparison.different else 0)


if __name__ == "__main__":
    main()
