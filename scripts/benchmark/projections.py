#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds our projection uncertainty and difference against mrcal's, on the same corners.

Uncertainty: of every tag only its first corner is kept (they form the regular board that mrcal
asks for), on every n-th frame of camera 0. Both calibrate from these corners without loss and
regularisation; then the standard deviation along the worst direction is compared on a grid, at
infinity and at 1 m, for corners of 1 px. mrcal of Debian 12 (2.2) knows mean-frames only, so ours
is run with --uncertainty mean-frames; cross-reprojection stands beside it.

Difference: the calibration from even frames against that from odd ones, by mrcal.projection_diff()
and by `plumbline compare`: same focus region, same fit (fourth power), same grid.

    projections.py --plumbline build/evaluate/plumbline SESSION [--stride 20]
"""
import argparse
import json
import os
import subprocess
import tempfile

import numpy as np

import sessions
from rivals import read_yaml_numbers
from tables import Table

GRID = (31, 21)


def board_session(session, stamps, out):
    """Camera 0 at these stamps with the first corner of every tag."""
    sessions.subset(session, set(stamps), out)
    path = os.path.join(out, "cam0", "corners.csv")
    with open(path, encoding="utf-8") as file:
        lines = file.readlines()
    kept = [line for line in lines if line.startswith("#") or int(line.split(",")[1]) % 4 == 0]
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(kept)
    return out


def calibrate(plumbline, session, out):
    subprocess.run([plumbline, "calibrate", session, "--only", "cam0", "--no-imu", "--loss", "none",
                    "--models", "pinhole-radtan", "--target-shape", "flat", "--no-halves",
                    "--min-corners", "8", "--no-report", "--no-cache", "--out", out],
                   check=True, capture_output=True)
    return os.path.join(out, "calibration.json")


def compare(plumbline, first, second, out, *arguments):
    subprocess.run([plumbline, "compare", first, second, "--labels", "a,b", "--loss", "none",
                    "--min-corners", "8", "--grid", f"{GRID[0]}x{GRID[1]}", "--range", "inf,1",
                    "--no-report", "--out", out, *arguments], check=True, capture_output=True)
    with open(os.path.join(out, "comparison.json"), encoding="utf-8") as file:
        return json.load(file)


def our_map(maps, label, range_m):
    for m in maps:
        if m["label"] == label and m.get("range_m") == range_m:
            return m
    raise KeyError((label, range_m))


def grid_values(m):
    return np.array(m["values_px"], dtype=float).reshape(m["rows"], m["columns"])


def mrcal_model(session, calibration):
    """mrcal's own solution from our intrinsics, on the regular board of first corners."""
    import cv2
    import mrcal
    target = read_yaml_numbers(os.path.join(session, "target.yaml"))
    rows, cols = int(target["tagRows"]), int(target["tagCols"])
    pitch = target["tagSize"] * (1 + target["tagSpacing"])
    data = np.loadtxt(os.path.join(session, "cam0", "corners.csv"), delimiter=",",
                      dtype=[("t", "i8"), ("id", "i4"), ("u", "f8"), ("v", "f8")])
    views = [v for v in np.split(data, np.flatnonzero(np.diff(data["t"])) + 1) if len(v) >= 8]
    camera = calibration["cameras"][0]
    fu, fv, pu, pv = camera["intrinsics"]
    intrinsics = np.array([[fu, fv, pu, pv, *camera["distortion_coeffs"]]], dtype=float)
    K = np.array([[fu, 0, pu], [0, fv, pv], [0, 0, 1]])
    d = np.array(camera["distortion_coeffs"])
    board = np.zeros((len(views), rows, cols, 3)) - 1.0
    poses = []
    for k, view in enumerate(views):
        tag = view["id"] // 4
        board[k, tag // cols, tag % cols] = np.column_stack([view["u"], view["v"],
                                                             np.ones(len(view))])
        points = np.column_stack([pitch * (tag % cols), pitch * (tag // cols), np.zeros(len(tag))])
        uv = np.column_stack([view["u"], view["v"]])
        _, r, t = cv2.solvePnP(points, uv, K, d, flags=cv2.SOLVEPNP_IPPE)
        _, r, t = cv2.solvePnP(points, uv, K, d, r, t, True, cv2.SOLVEPNP_ITERATIVE)
        poses.append(np.concatenate([r.ravel(), t.ravel()]))
    n = len(views)
    inputs = dict(
        intrinsics=intrinsics, extrinsics_rt_fromref=np.zeros((0, 6)),
        frames_rt_toref=np.array(poses), points=None, observations_board=board,
        indices_frame_camintrinsics_camextrinsics=np.column_stack(
            [np.arange(n), np.zeros(n), -np.ones(n)]).astype(np.int32),
        observations_point=None, indices_point_camintrinsics_camextrinsics=None,
        lensmodel="LENSMODEL_OPENCV4", imagersizes=np.array([camera["resolution"]], dtype=np.int32),
        calobject_warp=None, calibration_object_spacing=pitch,
        do_optimize_intrinsics_core=True, do_optimize_intrinsics_distortions=True,
        do_optimize_extrinsics=True, do_optimize_frames=True, do_optimize_calobject_warp=False,
        do_apply_outlier_rejection=False, do_apply_regularization=False, verbose=False)
    mrcal.optimize(**inputs)
    return mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=0), n


def mrcal_uncertainty(model, range_m):
    import mrcal
    v, _ = mrcal.sample_imager_unproject(*GRID, *model.imagersize(), *model.intrinsics(),
                                         normalize=True)
    return mrcal.projection_uncertainty(v * (range_m or 1), model, atinfinity=range_m is None,
                                        observed_pixel_uncertainty=1.0,
                                        what="worstdirection-stdev")


def uncertainty_table(ours, cross, model):
    table = Table("range", "where", "mrcal [px]", "ours, mean-frames [px]", "ratio",
                  "cross-reprojection [px]")
    bounds = []
    for range_m, name in ((None, "infinity"), (1.0, 1.0)):
        theirs = mrcal_uncertainty(model, range_m)
        mean = grid_values(our_map(ours["uncertainties"], "a", range_m))
        other = grid_values(our_map(cross["uncertainties"], "a", range_m))
        for where, at in (("centre", (GRID[1] // 2, GRID[0] // 2)), ("top left", (0, 0)),
                          ("top right", (0, -1)), ("bottom left", (-1, 0)),
                          ("bottom right", (-1, -1))):
            table.add(name if range_m is None else "1 m", where, f"{theirs[at]:.5f}",
                      f"{mean[at]:.5f}", f"{mean[at] / theirs[at]:.6f}", f"{other[at]:.5f}")
        ratio = mean / theirs
        bounds.append((np.nanmin(ratio), np.nanmax(ratio)))
    return table, bounds


def sum_of_fourth_powers(models, T_BA, distance):
    """What mrcal minimises, over its focus region: sum of th^4, th the angle between the rays."""
    import mrcal
    v, q = mrcal.sample_imager_unproject(
        *GRID, *models[0].imagersize(), [m.intrinsics()[0] for m in models],
        [m.intrinsics()[1] for m in models], normalize=True)
    size = np.array(models[0].imagersize())
    inside = np.linalg.norm(q - (size - 1) / 2, axis=-1) < min(size) / 6
    a, b = v[0][inside] * (distance or 1), v[1][inside]
    moved = a @ T_BA[:3, :3].T + T_BA[:3, 3]
    moved /= np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.sum(np.sum((moved - b) ** 2, axis=-1) ** 2)


def difference_table(ours, models):
    """mrcal's own fit starts at random, so it runs five times."""
    import mrcal
    table = Table("range", "ours, centre / corner [px]", "mrcal's, five runs [px]",
                  "largest deviation with one alignment [px]", "sum of th^4, mrcal's least / ours")
    for distance, name in ((None, "infinity"), (1.0, 1.0)):
        m = our_map(ours["differences"], "b - a", distance)
        own = np.array(m["vectors_px"], dtype=float).reshape(m["rows"], m["columns"], 2)
        T = np.array(m["implied_T_BA"])
        grid = {"gridn_width": GRID[0], "gridn_height": GRID[1], "distance": distance}
        _, same, _, _ = mrcal.projection_diff(models, implied_Rt10=np.vstack([T[:3, :3], T[:3, 3]]),
                                              **grid)
        runs = [mrcal.projection_diff(models, use_uncertainties=False, **grid) for _ in range(5)]
        sizes = [(f"{np.linalg.norm(d[GRID[1] // 2, GRID[0] // 2]):.4f}",
                  f"{np.linalg.norm(d[0, 0]):.4f}") for d in [own] + [run[1] for run in runs]]
        sums = []
        for run in runs:
            T_mrcal = np.eye(4)
            T_mrcal[:3, :3], T_mrcal[:3, 3] = run[3][:3], run[3][3]
            sums.append(sum_of_fourth_powers(models, T_mrcal, distance))
        theirs = [f"{min(s[k] for s in sizes[1:])} to {max(s[k] for s in sizes[1:])}"
                  for k in (0, 1)]
        table.add(name if distance is None else "1 m", " / ".join(sizes[0]), " / ".join(theirs),
                  f"{np.nanmax(np.abs(own - same)):.2g}",
                  f"{min(sums) / sum_of_fourth_powers(models, T, distance):.4f}")
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--plumbline", required=True)
    parser.add_argument("--stride", type=int, default=20)
    parser.add_argument("session")
    options = parser.parse_args()
    every = sessions.stamps(options.session)[:: options.stride]
    with tempfile.TemporaryDirectory() as work:
        halves, calibrations, models = [], [], []
        for k in (0, 1):
            half = board_session(options.session, every[k::2], os.path.join(work, f"half{k}"))
            halves.append(half)
            calibrations.append(calibrate(options.plumbline, half, os.path.join(work, f"out{k}")))
            with open(calibrations[-1], encoding="utf-8") as file:
                model, frames = mrcal_model(half, json.load(file))
            models.append(model)
        common = ["--session", halves[0], "--no-cache"]
        mean = compare(options.plumbline, *calibrations, os.path.join(work, "mean"),
                       "--uncertainty", "mean-frames", *common)
        cross = compare(options.plumbline, *calibrations, os.path.join(work, "cross"), *common)
        plain = compare(options.plumbline, calibrations[0], calibrations[1],
                        os.path.join(work, "plain"), "--fit", "fourth-power", "--focus-radius",
                        str(min(models[0].imagersize()) / 6))
        table, bounds = uncertainty_table(mean, cross, models[0])
        with open(calibrations[0], encoding="utf-8") as file:
            own = json.load(file)["cameras"][0]
        apart = np.abs(np.array(own["intrinsics"] + own["distortion_coeffs"]) -
                       models[0].intrinsics()[1]).max()
        print(f"Projection uncertainty, {frames} frames of 1 px corners (largest difference of an "
              f"intrinsic parameter: {apart:.2g}); over the grid ours / mrcal is "
              f"{bounds[0][0]:.6f} to {bounds[0][1]:.6f} at infinity, {bounds[1][0]:.6f} to "
              f"{bounds[1][1]:.6f} at 1 m:\n")
        print(table.text())
        print("\nProjection difference, even against odd frames:\n")
        print(difference_table(plain, models).text())


if __name__ == "__main__":
    main()
