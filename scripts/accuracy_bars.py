#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the bars of accuracy on EuRoC's two calibration recordings and prints them in one table:
accuracy_bars.py PROGRAM DATA [--docs docs/target_shape.md] [--deviations]

DATA holds euroc_imu_april and euroc_cam_april_images. With --docs the table replaces the one between the
lines "<!-- bars -->" and "<!-- end of bars -->". With --deviations it measures instead whether the deviations
hold: quarters of imu_april are calibrated apart, and compared with each other, and the two sessions with each
other; it prints which share of the differences is within two cluster-robust deviations. Ends with 1 where a
bar is missed.
"""
import argparse
import itertools
import json
import math
import pathlib
import subprocess
import sys
import tempfile

SPLIT_S = 36
BEGIN, END = "<!-- bars -->\n", "<!-- end of bars -->"


def shape_held_out_px(fit):
    """RMS of held-out frames with the board that was kept: the finest detail that it has."""
    for shape, error in (("corners", "corners_held_out_px"), ("higher", "higher_held_out_px")):
        if fit["shape"].get(shape) is not None:
            return fit[error]
    return fit["held_out_px"]


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr.strip()}")


class Results:
    """Calibrations and scores of the two recordings, in a folder of their own."""

    def __init__(self, program, data, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.imu = data / "euroc_imu_april"
        self.cam = data / "euroc_cam_april_images"

    def calibrated(self, name, session, *options):
        out = self.folder / name
        run(self.program, "calibrate", session, "--out", out, "--no-report", "--no-halves", *options)
        return json.loads((out / "calibration.json").read_text())

    def scored(self, name, session, shape):
        """RMSE of a calibration's cameras on a session, only poses moving [px]."""
        out = self.folder / "score"
        run(self.program, "evaluate", "calibration", self.folder / name / "calibration.json", session, "--loss", "none",
            "--target-shape", shape, "--no-report", "--out", out, "--force")
        return json.loads((out / "evaluation.json").read_text())["scores"][0]["reprojection"]["rmse_px"]


def lens(document, camera):
    """fu, fv, pu, pv [px], the focal lengths as they are on the optical axis, whatever the model"""
    stated = document["cameras"][camera]
    *shape, fu, fv, pu, pv = stated["intrinsics"]
    axis = 1 + shape[0] if stated["model"] in ("ds", "omni") else 1
    return [fu / axis, fv / axis, pu, pv]


def differences(a, b):
    """Largest over both cameras of |fu|, |fv|, |pu|, |pv| [px]"""
    return [max(abs(x - y) for x, y in zip(column_a, column_b))
            for column_a, column_b in zip(zip(lens(a, 0), lens(a, 1)), zip(lens(b, 0), lens(b, 1)))]


def lever_arm_mm(document):
    return [1e3 * row[3] for row in document["imu"]["T_SC0"][:3]]


def rows_of(results):
    whole = results.calibrated("whole", results.imu)
    first = results.calibrated("first", results.imu, "--to", SPLIT_S)
    rest = results.calibrated("rest", results.imu, "--from", SPLIT_S)
    other = results.calibrated("other", results.cam)
    shape = results.folder / "other" / "target_shape.yaml"
    known = results.calibrated("known", results.cam, "--target-shape", results.folder / "whole" / "target_shape.yaml")
    halves, sessions = differences(first, rest), differences(whole, other)
    arm = max(abs(x - y) for x, y in zip(lever_arm_mm(first), lever_arm_mm(rest)))
    camera = other["stages"]["camera"]
    given = known["stages"]["camera"]["target_fit"]
    return [
        ("imu_april, first 36 s and the rest: fu, fv [px]", max(halves[:2]), 0.5),
        ("the same: pu, pv [px]", max(halves[2:]), 0.3),
        ("the same: T_SC0's translation, each axis [mm]", arm, 3),
        ("imu_april and cam_april's images: fu, fv [px]", max(sessions[:2]), 0.6),
        ("the same: pu, pv [px]", max(sessions[2:]), 0.5),
        ("imu_april's cameras on cam_april, flat board [px RMS]", results.scored("whole", results.cam, "flat"), 0.24),
        ("the same, cam_april's own board [px RMS]", results.scored("whole", results.cam, shape), 0.10),
        ("cam_april, own board, itself [px RMS]", camera["rmse_px"], 0.070),
        ("the same, held-out frames [px RMS]", shape_held_out_px(camera["target_fit"]), 0.074),
        ("cam_april, imu_april's board, held-out frames [px RMS]", given["flat_held_out_px"], 0.080),
    ]


QUARTERS_S = ((0, 18), (18, 36), (36, 54), (54, None))
LEAST_WITHIN = 0.85


def turn(a, b):
    """Rotation vector of R_a R_b^T, small turns [rad]; 4 x 4 transforms"""
    r = [[sum(a[i][k] * b[j][k] for k in range(3)) for j in range(3)] for i in range(3)]
    return [0.5 * (r[2][1] - r[1][2]), 0.5 * (r[0][2] - r[2][0]), 0.5 * (r[1][0] - r[0][1])]


def moved(a, b):
    return [a[i][3] - b[i][3] for i in range(3)] + turn(a, b)


def normalised_differences(a, b):
    """(name, difference over the deviation of it) of two calibrations with the same lens models"""
    names, values = [], []
    for one, other in zip(a["cameras"], b["cameras"]):
        words = ("fu", "fv", "pu", "pv", "k1", "k2", "k3", "k4")
        stacked = [c["intrinsics"] + c["distortion_coeffs"] for c in (one, other)]
        names += [f"{one['name']}.{word}" for word in words]
        values += [x - y for x, y in zip(*stacked)]
    axes = ("tx", "ty", "tz", "rx", "ry", "rz")
    for one, other in zip(a["cameras"][1:], b["cameras"][1:]):
        names += [f"T_C0C1.{axis}" for axis in axes]
        values += moved(one["T_C0Ci"], other["T_C0Ci"])
    deviations = [x["stages"]["camera"]["robust_std"] for x in (a, b)]
    if "imu" in a and "imu" in b:
        names += [f"T_SC0.{axis}" for axis in axes] + ["time_offset"]
        values += moved(a["imu"]["T_SC0"], b["imu"]["T_SC0"])
        values.append(a["imu"]["time_offset_s"] - b["imu"]["time_offset_s"])
        deviations = [s + x["stages"]["camera_imu"]["robust_std"] for s, x in zip(deviations, (a, b))]
    return [(name, value / math.hypot(s, t)) for name, value, s, t in zip(names, values, *deviations)]


def measure_deviations(results):
    """Prints a table; false where a share is below its bar."""
    model = ("--models", "pinhole-equidistant")
    quarters = []
    for i, (begin, end) in enumerate(QUARTERS_S):
        cut = ["--from", begin] + ([] if end is None else ["--to", end])
        quarters.append(results.calibrated(f"quarter{i}", results.imu, *cut, *model))
    sessions = [results.calibrated("imu", results.imu, *model), results.calibrated("cam", results.cam, *model)]
    groups = [
        ("imu_april, each two quarters of 18 s", [x for pair in itertools.combinations(quarters, 2)
                                                  for x in normalised_differences(*pair)]),
        ("imu_april and cam_april's images", normalised_differences(*sessions)),
    ]
    groups.append(("all", groups[0][1] + groups[1][1]))
    print("| parameters of | differences | within 2 sigma | largest |\n|---|---|---|---|")
    for name, differences in groups:
        within = sum(abs(z) <= 2 for _, z in differences) / len(differences)
        worst = max(differences, key=lambda x: abs(x[1]))
        print(f"| {name} | {len(differences)} | {100 * within:.0f} % | {worst[0]}, {abs(worst[1]):.1f} sigma |")
    return within >= LEAST_WITHIN


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--docs", type=pathlib.Path)
    parser.add_argument("--deviations", action="store_true")
    arguments = parser.parse_args()
    if arguments.deviations:
        with tempfile.TemporaryDirectory() as folder:
            sys.exit(not measure_deviations(Results(arguments.program, arguments.data, folder)))
    with tempfile.TemporaryDirectory() as folder:
        rows = rows_of(Results(arguments.program, arguments.data, folder))
    table = "| largest difference, or error | measured | bar |\n|---|---|---|\n"
    for name, value, bar in rows:
        table += f"| {name} | {value:.3g} | {bar:g}{'' if value <= bar else ' missed'} |\n"
    print(table)
    if arguments.docs:
        before, rest = arguments.docs.read_text().split(BEGIN)
        arguments.docs.write_text(before + BEGIN + table + END + rest.split(END, 1)[1])
    sys.exit(any(value > bar for _, value, bar in rows))


if __name__ == "__main__":
    main()
