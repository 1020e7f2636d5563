#!/usr/bin/env python3
"""Shows that the application on an emulated Cortex-M33 does what it shall: the host's bytes by every method, obstacles as the host
has them, the same counts in every run, and no harm from a fault of the camera beyond the frame it hits.

usage: firmware/checks/m33.py HAARLINE ELF DATA

HAARLINE is the host's program, ELF the twin for the M33 (cargo twin-m33), DATA the folder with qvga and stereoboard.
"""

from twin import FAULTS, SCENE, TAKE, fault, main, recording, repeatable, rig, scene
from verdicts import expect

SCENES = [SCENE, "cones", "v3q_motorcycle", "kitti15_000010"]
METHODS = ["full", "lite", "wavelet-block"]
OTHERS = ["contour", "envelope", "block", "sgm"]


def machine(twin):
    """The program itself says which machine it is for."""
    told = twin.run(*twin.scene(SCENE, "lite"))
    expect("machine and core", [told["machine"], told["core"]], ["an505", "Cortex-M33"])
    expect("chips that it is for", [estimate["chip"] for estimate in told["estimates"]], ["STM32U575@160"])
    return ""


def checks(twin):
    """Every check by its name."""
    yield "the program runs on an an505", lambda: machine(twin)
    for name, method in [(name, method) for name in SCENES for method in METHODS] + [(SCENE, method) for method in OTHERS]:
        yield f"{name}, {method}: the host's map", lambda n=name, m=method: scene(twin, n, m)
    yield f"recording {TAKE}, right first: the host's maps", lambda: recording(twin)
    yield f"recording {TAKE} with its rig: maps, obstacles", lambda: rig(twin, 1)
    yield "two runs tell the same", lambda: repeatable(twin)
    for kind in FAULTS:
        yield f"fault {kind}: counted, and the other frames as without it", lambda k=kind: fault(twin, k)


main(checks, __doc__)
