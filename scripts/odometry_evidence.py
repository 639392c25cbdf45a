#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does the built-in odometry feel a wrong calibration? Simulates flights (`simulate sequence`), runs
each with the true calibration, with a camera-IMU rotation wrong by 0.5 degrees, a time offset wrong
by 5 ms and focal lengths wrong by 1 %, and prints the table of docs/odometry.md: ATE in cm against
the exact truth, and the medians over paired seeds of what each adds.

  scripts/odometry_evidence.py --plumbline build/evaluate/plumbline --work FOLDER [--seeds 5] \\
      [--duration 40] [--turns 4] [--images]

Flights and runs are kept in --work, and not made again.
"""

import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess

KINDS = {"true": "true", "rotation": "rotation 0.5 degrees", "offset": "offset 5 ms",
         "focal": "focal lengths 1 %"}


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(t):
    """Of a rigid transform."""
    r = [[t[j][i] for j in range(3)] for i in range(3)]
    p = [-sum(r[i][k] * t[k][3] for k in range(3)) for i in range(3)]
    return [r[i] + [p[i]] for i in range(3)] + [[0, 0, 0, 1]]


def rotation(angle):
    """About (1, 1, 1)."""
    c, s, a = math.cos(angle), math.sin(angle) / math.sqrt(3), (1 - math.cos(angle)) / 3
    return [[c + a, a - s, a + s, 0], [a + s, c + a, a - s, 0], [a - s, a + s, c + a, 0],
            [0, 0, 0, 1]]


MATRIX = re.compile(r"(T_cam_imu:\n)((?:  - \[.*\]\n){4})")


def spoiled(text, kind):
    """Kalibr's camchain with the error."""
    if kind == "offset":
        return re.sub(r"timeshift_cam_imu: (\S+)",
                      lambda m: f"timeshift_cam_imu: {float(m[1]) + 0.005!r}", text)
    if kind == "focal":
        def longer(m):
            values = [float(v) for v in m[1].split(",")]
            values[-4:-2] = [1.01 * v for v in values[-4:-2]]
            return f"intrinsics: {values}"
        return re.sub(r"intrinsics: \[(.*)\]", longer, text)
    if kind == "rotation":
        rows = [[[float(v) for v in row[5:-1].split(",")] for row in m[2].splitlines()]
                for m in MATRIX.finditer(text)]
        wrong = inverse(product(inverse(rows[0]), rotation(math.radians(0.5))))  # camera 0 from IMU
        after = iter([product(product(t, inverse(rows[0])), wrong) for t in rows])
        return MATRIX.sub(lambda m: m[1] + "".join(f"  - {row!r}\n" for row in next(after)), text)
    return text


def errors(program, work, seed, options):
    """ATE [m] by kind, and the length of the way."""
    flight = work / f"seed{seed}"
    if not flight.exists():
        subprocess.run([program, "simulate", "sequence", "--seed", str(seed), "--out", flight,
                        *options], check=True, stdout=subprocess.DEVNULL)
    out = work / f"loop{seed}"
    if not out.exists():
        text = (flight / "truth/camchain-imucam.yaml").read_text()
        arguments = []
        for kind in KINDS:
            (work / f"{kind}.yaml").write_text(spoiled(text, kind))
            arguments += ["--calibration", work / f"{kind}.yaml"]
        subprocess.run([program, "odometry", flight, *arguments, "--clock-offset", "auto",
                        "--truth", flight / "truth/trajectory.csv", "--out", out],
                       check=True, stdout=subprocess.DEVNULL)
    runs = json.loads((out / "odometry.json").read_text())["runs"]
    length = json.loads((flight / "truth/truth.json").read_text())["length_m"]
    bad = [r for r in runs if r["status"] != "complete"]
    if bad:
        raise SystemExit(f"seed {seed}, {bad[0]['calibration']}: {bad[0]['problem']}")
    return {r["calibration"]: r["ate"]["translation_m"]["rmse"] for r in runs}, length


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plumbline", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--duration", type=float, default=40)
    parser.add_argument("--turns", type=int, default=4)
    parser.add_argument("--images", action="store_true")
    o = parser.parse_args()
    o.work.mkdir(parents=True, exist_ok=True)
    options = ["--duration", str(o.duration), "--turns", str(o.turns)]
    options += ["--images"] if o.images else []
    # Flights made with other options are others.
    work = o.work / "".join(options).replace("--", "-").strip("-")
    work.mkdir(exist_ok=True)
    table = [errors(o.plumbline, work, seed, options) for seed in range(1, o.seeds + 1)]
    print("| ATE [cm] | " + " | ".join(f"seed {i + 1}, {length:.0f} m"
                                      for i, (_, length) in enumerate(table)) +
          " | median increase |")
    print("|" + "---|" * (len(table) + 2))
    for kind, name in KINDS.items():
        row = [ate[kind] for ate, _ in table]
        added = statistics.median(ate[kind] - ate["true"] for ate, _ in table)
        print(f"| {name} | " + " | ".join(f"{100 * x:.2f}" for x in row) + f" | {100 * added:+.2f} |")


if __name__ == "__main__":
    main()
