#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which loss the corners should have: calibrates with each, scores the cameras where they were not estimated:
loss_study.py PROGRAM DATA [--seeds 3] [--docs docs/models.md]

EuRoC: each of euroc_imu_april and euroc_cam_april_images (in DATA) trains, the other one scores with squared
error, only poses moving; with the board's shape estimated (and the other's own board in the score) and flat.
Simulated: 20 s of stereo with 0, 2 and 10 % of false corners, scored on another recording without any, and
against the truth. With --docs the tables replace what stands between "<!-- loss -->" and "<!-- end of loss -->".
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

LOSSES = {
    "squared": ["--loss", "none"],
    "squared, 4 sigma rejected": ["--loss", "none", "--outliers", "sigma:4"],
    "Cauchy 1.5 px": ["--loss", "cauchy:1.5"],
    "Cauchy 3 px": ["--loss", "cauchy:3"],
}
SHARES = [0, 0.02, 0.1]
BEGIN, END = "<!-- loss -->\n", "<!-- end of loss -->"


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr.strip()}")


def calibrated(program, session, out, *options):
    run(program, "calibrate", session, "--out", out, "--no-report", "--no-halves", *options)
    return json.loads((out / "calibration.json").read_text())


def scored(program, calibration, session, shape, folder):
    """RMSE and median of the reprojection error, only poses moving [px]"""
    run(program, "evaluate", "calibration", calibration, session, "--loss", "none", "--target-shape", shape,
        "--no-report", "--out", folder / "score", "--force")
    errors = json.loads((folder / "score" / "evaluation.json").read_text())["scores"][0]["reprojection"]
    return errors["rmse_px"], errors["median_px"]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def euroc_rows(program, data, folder):
    sessions = {"imu_april": data / "euroc_imu_april", "cam_april": data / "euroc_cam_april_images"}
    for shape in ("auto", "flat"):
        for i, options in enumerate(LOSSES.values()):
            for name, session in sessions.items():
                calibrated(program, session, folder / f"{name}_{shape}_{i}", "--target-shape", shape, *options)
    for trained, other in (("imu_april", "cam_april"), ("cam_april", "imu_april")):
        for shape in ("auto", "flat"):
            # One board for all losses in the score: the other session's own, as its default run finds it.
            board = folder / f"{other}_auto_{len(LOSSES) - 1}" / "target_shape.yaml" if shape == "auto" else "flat"
            for i, loss in enumerate(LOSSES):
                rmse, median = scored(program, folder / f"{trained}_{shape}_{i}" / "calibration.json", sessions[other],
                                      board, folder)
                yield trained, other, shape, loss, f"{rmse:.4f}", f"{median:.4f}"


def arm_error_mm(document, truth):
    a, b = (d["imu"]["T_SC0"] for d in (document, truth))
    return 1e3 * math.dist([row[3] for row in a[:3]], [row[3] for row in b[:3]])


def simulated_rows(program, seeds, folder):
    run(program, "simulate", "--seed", 1000, "--duration", 20, "--out", folder / "clean")
    for share in SHARES:
        errors = {loss: [] for loss in LOSSES}
        for seed in range(1, seeds + 1):
            session = folder / f"simulated_{share}_{seed}"
            run(program, "simulate", "--seed", seed, "--duration", 20, "--outliers", share, "--out", session)
            truth = json.loads((session / "truth" / "truth.json").read_text())
            for i, (loss, options) in enumerate(LOSSES.items()):
                out = folder / f"calibrated_{share}_{seed}_{i}"
                document = calibrated(program, session, out, *options)
                rmse, _ = scored(program, out / "calibration.json", folder / "clean", "flat", folder)
                offset = document["stages"]["camera_imu"]["time_offset_s"] - truth["imu"]["time_offset_s"]
                errors[loss].append((rmse, arm_error_mm(document, truth), 1e6 * abs(offset)))
        for loss, values in errors.items():
            rms = [math.sqrt(sum(v * v for v in column) / len(column)) for column in zip(*values)]
            yield f"{share:.0%}", loss, f"{rms[0]:.4f}", f"{rms[1]:.2f}", f"{rms[2]:.1f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=3, help="simulated recordings of each share of false corners")
    parser.add_argument("--docs", type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = table(["trained on", "scored on", "board", "loss", "RMSE [px]", "median [px]"],
                     euroc_rows(options.program, options.data, folder))
        text += "\n" + table(["false corners", "loss", "RMSE on a clean recording [px]",
                              "T_SC0's translation off by [mm]", "time offset off by [us]"],
                             simulated_rows(options.program, options.seeds, folder))
    print(text, end="")
    if not options.docs:
        return
    document = options.docs.read_text()
    before, rest = document.split(BEGIN)
    options.docs.write_text(before + BEGIN + text + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
