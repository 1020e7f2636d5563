#!/usr/bin/env python3
"""Decodes what `haarline play --mavlink` writes with pymavlink, as an autopilot would, and compares it with
obstacles.csv and with the scene: a post at 1.5 m on flat ground, a wall at 6 m.

    python3 tests/obstacle_distance.py HAARLINE      (needs pymavlink)
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

UNKNOWN = 65535
FRAMES = 32
RATE = 5  # frames a second of `haarline rig new`


def make(haarline, folder, method):
    """Records frames of the rendered scene, plays them, and returns the messages and the table."""
    run = lambda *arguments: subprocess.run([haarline, *arguments], check=True, cwd=folder, stdout=subprocess.DEVNULL)
    for side in ("left", "right"):
        os.makedirs(os.path.join(folder, "take", side), exist_ok=True)
    for seed in range(2):
        run("demo", "--scene", "rover", "--seed", str(seed), "-o", "scene", "--method", "lite")
        for frame in range(seed, FRAMES, 2):
            for side in ("left", "right"):
                shutil.copy(os.path.join(folder, "scene", side + ".png"),
                            os.path.join(folder, "take", side, f"{frame:03}.png"))
    if not os.path.exists(os.path.join(folder, "rig.toml")):
        run("rig", "new", "rig.toml")
    run("play", "take", "-o", "out", "--rig", "rig.toml", "--mavlink", "out.mavlink", "--method", method)
    with open(os.path.join(folder, "out.mavlink"), "rb") as file:
        raw = file.read()
    decoder = mavlink.MAVLink(None)
    decoder.robust_parsing = False  # a bad byte is an error, not something to be skipped
    messages = decoder.parse_buffer(raw)
    assert sum(len(message.get_msgbuf()) for message in messages) == len(raw), "bytes that are no message"
    with open(os.path.join(folder, "out", "obstacles.csv"), newline="") as file:
        table = list(csv.reader(file))
    return messages, table


def check(messages, table):
    bearings, rows = [int(field) for field in table[0][1:]], table[1:]
    assert [message.get_seq() for message in messages] == [i % 256 for i in range(len(messages))]
    for message in messages:
        assert (message.get_srcSystem(), message.get_srcComponent()) == (1, 196), message
    beats = [message for message in messages if message.get_type() == "HEARTBEAT"]
    assert len(beats) == -(-FRAMES // RATE) and messages[0] is beats[0], "one heartbeat a second"
    for beat in beats:
        assert beat.type == mavlink.MAV_TYPE_ONBOARD_CONTROLLER
        assert beat.autopilot == mavlink.MAV_AUTOPILOT_INVALID
        assert beat.system_status == mavlink.MAV_STATE_ACTIVE
    found = [message for message in messages if message.get_type() == "OBSTACLE_DISTANCE"]
    assert len(found) == len(rows) == FRAMES and len(messages) == FRAMES + len(beats)
    for index, (message, row) in enumerate(zip(found, rows)):
        assert message.frame == mavlink.MAV_FRAME_BODY_FRD
        assert (message.increment, message.increment_f, message.angle_offset) == (5, 0.0, -40.0)
        assert (message.min_distance, message.max_distance) == (25, 1200)
        assert message.time_usec == index * (1_000_000 // RATE)
        assert bearings == [int(message.angle_offset) + message.increment * i for i in range(len(bearings))]
        told = [UNKNOWN if field == "" or int(field) > message.max_distance else int(field) for field in row[1:]]
        assert list(message.distances) == told + [UNKNOWN] * (72 - len(told)), index
        by_bearing = dict(zip(bearings, message.distances))
        assert 140 <= by_bearing.pop(0) <= 160, f"frame {index}: the post at 150 cm: {message.distances[8]}"
        # The post may reach into the sectors beside its own.
        beside = [by_bearing.pop(bearing) for bearing in (-5, 5)]
        assert all(cm == UNKNOWN or cm > 400 or 140 <= cm <= 160 for cm in beside), f"frame {index}: {beside}"
        assert all(cm == UNKNOWN or cm > 400 for cm in by_bearing.values()), f"frame {index}: {by_bearing}"
    return [message.distances[bearings.index(0)] for message in found]


def main():
    haarline = os.path.abspath(sys.argv[1])
    for method in ("full", "lite"):
        with tempfile.TemporaryDirectory() as folder:
            messages, table = make(haarline, folder, method)
            post = check(messages, table)
            print(f"{method}: {len(messages)} messages decode, the post reads {min(post)} to {max(post)} cm")


if __name__ == "__main__":
    main()
