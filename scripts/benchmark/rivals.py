#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Calibrates one camera of a session with mrcal or OpenCV, on the very corners we use.

Reads camN/corners.csv, target.yaml and camN/sensor.yaml; model: pinhole with k1 k2 p1 p2, squared
error, no outlier rejection, no regularisation. Prints one JSON object: the RMSE (of the error norm,
over corners), the intrinsics, and the seconds of CPU and wall spent seeding and solving (reading
files and importing modules excluded, in the rivals' favour). mrcal is seeded with focal length and
poses by OpenCV, since its own seed needs full boards; OpenCV seeds itself.

    rivals.py mrcal|OpenCV SESSION [--camera 0]
"""
import argparse
import json
import os
import re
import resource
import time

import numpy as np

from sessions import asl_folder


def read_yaml_numbers(path):
    """Keys with a number or a list of numbers: all that target.yaml and sensor.yaml need."""
    values = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            match = re.match(r"\s*(\w+)\s*:\s*(\[.*?\]|[-+.\deE]+)\s*(#.*)?$", line)
            if match:
                values[match.group(1)] = json.loads(match.group(2))
    return values


def corner_positions(target):
    pitch = target["tagSize"] * (1 + target["tagSpacing"])
    ids = np.arange(4 * int(target["tagRows"]) * int(target["tagCols"]))
    tag, corner = ids // 4, ids % 4
    x = pitch * (tag % int(target["tagCols"])) + target["tagSize"] * np.isin(corner, (1, 2))
    y = pitch * (tag // int(target["tagCols"])) + target["tagSize"] * np.isin(corner, (2, 3))
    return np.stack([x, y, np.zeros_like(x)], axis=1)


def read_views(folder):
    """(corner ids, pixels) of every frame that has 8 corners or more."""
    rows = np.loadtxt(os.path.join(folder, "corners.csv"), delimiter=",",
                      dtype=[("t", "i8"), ("id", "i4"), ("u", "f8"), ("v", "f8")])
    views = np.split(rows, np.flatnonzero(np.diff(rows["t"])) + 1)
    return [(view["id"], np.stack([view["u"], view["v"]], axis=1)) for view in views
            if len(view) >= 8]


def seed(views, points, size):
    """Focal length and poses as OpenCV's own tools would start: initCameraMatrix2D, solvePnP."""
    import cv2
    full = [v for v in views if len(v[0]) >= 24]
    some = full[:: max(1, len(full) // 30)]
    K = cv2.initCameraMatrix2D([points[i].astype(np.float32) for i, _ in some],
                               [uv.astype(np.float32) for _, uv in some], size)
    poses = []
    for ids, uv in views:
        _, r, t = cv2.solvePnP(points[ids], uv, K, None, flags=cv2.SOLVEPNP_IPPE)
        _, r, t = cv2.solvePnP(points[ids], uv, K, None, r, t, True, cv2.SOLVEPNP_ITERATIVE)
        poses.append(np.concatenate([r.ravel(), t.ravel()]))
    return K, np.array(poses)


def run_mrcal(views, points, size):
    import mrcal
    K, poses = seed(views, points, size)
    seeded = (time.perf_counter(), time.process_time())
    observations, indices = [], []
    for k, (ids, uv) in enumerate(views):
        observations.append(np.column_stack([uv, np.ones(len(ids))]))
        indices.append(np.column_stack([ids, np.zeros(len(ids)), np.full(len(ids), k)]))
    intrinsics = np.array([[K[0, 0], K[1, 1], K[0, 2], K[1, 2], 0, 0, 0, 0]], dtype=float)
    stats = mrcal.optimize(
        intrinsics=intrinsics, extrinsics_rt_fromref=poses, frames_rt_toref=None, points=points,
        observations_board=None, indices_frame_camintrinsics_camextrinsics=None,
        observations_point=np.ascontiguousarray(np.vstack(observations)),
        indices_point_camintrinsics_camextrinsics=np.ascontiguousarray(
            np.vstack(indices).astype(np.int32)),
        Npoints_fixed=len(points), lensmodel="LENSMODEL_OPENCV4",
        imagersizes=np.array([size], dtype=np.int32),
        do_optimize_intrinsics_core=True, do_optimize_intrinsics_distortions=True,
        do_optimize_extrinsics=True, do_optimize_frames=False, do_optimize_calobject_warp=False,
        do_apply_outlier_rejection=False, do_apply_regularization=False,
        point_min_range=1e-3, point_max_range=1e3, verbose=False)
    count = sum(len(v[0]) for v in views)
    # Two residuals a corner; what follows them (range penalties of points) is zero here.
    rmse = np.sqrt(np.sum(stats["x"] ** 2) / count)
    return float(rmse), intrinsics[0].tolist(), seeded


def run_opencv(views, points, size):
    import cv2
    seeded = (time.perf_counter(), time.process_time())
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    rms, K, d, _, _ = cv2.calibrateCamera(
        [points[i].astype(np.float32) for i, _ in views],
        [uv.astype(np.float32) for _, uv in views], size, None, None,
        flags=cv2.CALIB_FIX_K3, criteria=criteria)
    d = d.ravel()
    return rms, [K[0, 0], K[1, 1], K[0, 2], K[1, 2], d[0], d[1], d[2], d[3]], seeded


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tool", choices=["mrcal", "OpenCV"])
    parser.add_argument("session")
    parser.add_argument("--camera", type=int, default=0)
    options = parser.parse_args()

    folder = os.path.join(asl_folder(options.session), f"cam{options.camera}")
    target = read_yaml_numbers(os.path.join(options.session, "target.yaml"))
    sensor = read_yaml_numbers(os.path.join(folder, "sensor.yaml"))
    views = read_views(folder)
    points = corner_positions(target)
    size = tuple(int(n) for n in sensor["resolution"])

    import cv2
    cv2.setNumThreads(1)
    if options.tool == "mrcal":
        import mrcal  # noqa: F401  (imported here so that the clock does not count it)
    wall, cpu = time.perf_counter(), time.process_time()
    rmse, intrinsics, seeded = {"mrcal": run_mrcal, "OpenCV": run_opencv}[options.tool](
        views, points, size)
    print(json.dumps({
        "tool": options.tool, "views": len(views), "corners": int(sum(len(v[0]) for v in views)),
        "rmse_px": rmse, "intrinsics": intrinsics,
        "seed_s": seeded[0] - wall, "solve_s": time.perf_counter() - seeded[0],
        "seed_cpu_s": seeded[1] - cpu, "solve_cpu_s": time.process_time() - seeded[1],
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))


if __name__ == "__main__":
    main()
