#!/usr/bin/env python3
"""Checks what the paper's studies must show in the tables that `haarline study all -o DIR` wrote.

usage: tests/study_claims.py DIR
"""

import csv
import sys
from pathlib import Path

folder = Path(sys.argv[1])


def rows(name, **wanted):
    """The rows of a table in which the columns hold these values."""
    with open(folder / name, newline="") as file:
        found = [row for row in csv.DictReader(file) if all(row[key] == value for key, value in wanted.items())]
    assert found, f"{name}: no row with {wanted}"
    return found


def number(row, start):
    """The figure in the column whose heading begins so."""
    return float(next(value for key, value in row.items() if key.startswith(start)))


failed = []


def check(claim, holds):
    print(("holds   " if holds else "FAILS   ") + claim)
    if not holds:
        failed.append(claim)


for row in rows("schwefel_methods.csv", method="proposed"):
    found, most = number(row, "found"), number(row, "most evaluations")
    needed = 135 if row["function"] == "Schwefel" else 0.85 * 150
    check(f"{row['function']}: {found:.0f} of 150 starts, at most {most:.0f} evaluations", found >= needed and most <= 400)

costs = sorted({row["cost"] for row in rows("noise_methods.csv")})
check(f"noise: unimodal and multimodal costs, {', '.join(costs)}", {"unimodal", "multimodal"} <= {c.split("(")[-1][:-1] for c in costs})
for cost in costs:
    by_method = {row["method"]: row for row in rows("noise_methods.csv", cost=cost, SNR="2")}
    proposed = by_method["proposed"]
    basics = [name for name in by_method if name.startswith("basic")]
    check(f"{cost}: two basic methods", len(basics) == 2)
    for name in basics:
        faster = number(by_method[name], "mean evaluations") / number(proposed, "mean evaluations")
        error = number(proposed, "relative error") / number(by_method[name], "relative error")
        check(f"SNR 2, {cost}, {name}: {faster:.2f} x fewer evaluations, {error:.2f} x the error", faster >= 1.1 and error <= 1)
    gradient = number(by_method["gradient descent"], "relative error") / number(proposed, "relative error")
    check(f"SNR 2, {cost}, gradient descent: {gradient:.1f} x the error", gradient > 1.5)

for row in rows("alignment_trials.csv"):
    iterations, within = number(row, "median iterations"), number(row, "within 0.5 px")
    check(f"alignment, {row['trials']}: median {iterations:g} iterations, {within} % within 0.5 px", iterations <= 12 and within >= 95)

for frames in ("clean", "sigma 10"):
    table = {row["method"]: row for row in rows("block_table1.csv", frames=frames)}
    for name in (name for name in table if name.startswith("wavelet-block") and name.endswith(("intensities", "Haar"))):
        tot2, limit = number(table[name], "tot2"), number(table["block, gates off"], "tot2")
        check(f"{frames}, {name}: tot2 {tot2} against {limit}", tot2 <= limit)
    # The chip has reading (b), and block with its gates.
    fewer = number(table["block"], "instructions") / number(table["wavelet-block (b), Haar"], "instructions")
    check(f"{frames}: wavelet-block executes {fewer:.2f} x fewer instructions than block", fewer >= 2)
    for row in rows("block_contour_points.csv", frames=frames, contours="contour", blocks="block"):
        contour, other = number(row, "bad2 of contours"), number(row, "bad2 of blocks")
        check(f"{frames}, bad2 at contour points: {contour} against {other}", contour <= other)

page = (folder / "index.html").read_text()
check("the page holds everything itself", "<svg" in page and "<script" not in page and "src=" not in page)
sys.exit(f"{len(failed)} claims fail" if failed else None)
