# Runs OpenCV's methods for `haarline bench`: a pair on the standard input, then a method's name a line; for each it
# answers with the nanoseconds of one compute().
import sys
import time

import cv2
import numpy as np

cv2.setNumThreads(1)
stdin, stdout = sys.stdin.buffer, sys.stdout
width, height, least, count = map(int, stdin.readline().split())
left, right = (np.frombuffer(stdin.read(width * height), np.uint8).reshape(height, width) for _ in range(2))
bm = cv2.StereoBM_create(count, 9)
bm.setMinDisparity(least)
matchers = {
    "StereoBM": bm,
    "StereoSGBM": cv2.StereoSGBM_create(least, count, 5, 8 * 25, 32 * 25, 1, 0, 10, 100, 2),
    "StereoSGBM_3WAY": cv2.StereoSGBM_create(least, count, 5, 8 * 25, 32 * 25, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY),
    "StereoSGBM_HH": cv2.StereoSGBM_create(least, count, 5, 8 * 25, 32 * 25, mode=cv2.STEREO_SGBM_MODE_HH),
}
print(cv2.__version__, flush=True)
for name in stdin:
    matcher = matchers[name.decode().strip()]
    begin = time.perf_counter_ns()
    matcher.compute(left, right)
    print(time.perf_counter_ns() - begin, flush=True)
