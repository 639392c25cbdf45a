#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails where an include points up through the layers, or a heavy library leaks out of its place.

The order is that of docs/conventions.md. A folder may include itself and the folders listed for it.
"""
import re
import subprocess
import sys

# What each room may include, besides itself and what stands below it in the same room. A room of
# several folders is named by their common parent.
BASE = ["calibrator/base"]
CORE = BASE + ["calibrator/camera", "calibrator/residuals", "calibrator/linear",
               "calibrator/information", "calibrator/initialise"]
CALIBRATOR = CORE + ["calibrator/target", "calibrator/batch", "calibrator/window",
                     "calibrator/simulate", "calibrator/guidance"]
DATASETS = ["datasets/files", "datasets/images", "datasets/calibration", "datasets/session",
            "datasets/trajectory"]
SHARED = CALIBRATOR + DATASETS + ["report/records", "report/store", "report/html",
                                  "evaluate/results", "evaluate/session", "evaluate/metrics"]
JOBS = ["evaluate/calibration", "evaluate/trajectory", "evaluate/compare", "evaluate/replay",
        "evaluate/studies"]

MAY_USE = {
    "calibrator/base": [],
    "calibrator/camera": BASE,
    "calibrator/target": BASE,
    "calibrator/residuals": BASE + ["calibrator/camera"],
    "calibrator/linear": BASE,
    "calibrator/information": BASE + ["calibrator/camera", "calibrator/linear"],
    "calibrator/initialise": BASE + ["calibrator/camera", "calibrator/residuals",
                                     "calibrator/linear"],
    "calibrator/batch": CORE,
    "calibrator/window": CORE + ["calibrator/batch"],
    "calibrator/simulate": BASE + ["calibrator/camera", "calibrator/target"],
    "calibrator/guidance": CORE + ["calibrator/batch", "calibrator/window", "calibrator/simulate"],
    "datasets/files": BASE,
    "datasets/images": BASE + ["datasets/files"],
    "datasets/calibration": BASE + ["calibrator/camera", "datasets/files"],
    "datasets/session": BASE + ["calibrator/camera", "calibrator/target", "calibrator/simulate",
                                "datasets/files", "datasets/images", "datasets/calibration"],
    "datasets/trajectory": BASE + ["datasets/files"],
    "report/records": BASE,
    "report/store": BASE + ["report/records"],
    "report/plots": BASE,
    "report/html": BASE + ["report/records", "report/plots"],
    "evaluate/results": BASE + DATASETS + ["report/records", "report/store", "report/html"],
    "evaluate/metrics": CORE + ["calibrator/batch", "report/records"],
    "evaluate/session": CALIBRATOR + DATASETS + ["report/records", "evaluate/results",
                                                 "evaluate/metrics"],
    **{job: SHARED for job in JOBS},
    "evaluate/cli": SHARED + JOBS,
}

# Third-party headers and where they may appear.
HEAVY = [
    (r"ceres/", "Ceres", ["calibrator/"]),
    (r"vtk\w+\.h", "VTK", ["report/"]),
    (r"(SQLiteCpp/|sqlite3\.h)", "SQLite", ["report/store/"]),
    (r"(rosbag|ros/)", "bag reader", ["datasets/"]),
    (r"opencv2/", "OpenCV", ["calibrator/target/", "calibrator/initialise/", "datasets/",
                             "evaluate/replay/"]),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def folder_of(path):
    matches = [f for f in MAY_USE if path.startswith(f + "/")]
    return max(matches, key=len) if matches else None


def check(path, faults):
    home = folder_of(path)
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            kind, target = match.groups()
            for pattern, name, places in HEAVY:
                if re.match(pattern, target) and not any(path.startswith(p) for p in places):
                    faults.append(f"{path}:{number}: {name} may be included only in "
                                  f"{', '.join(places)}")
            if kind != '"':
                continue
            there = folder_of(target)
            if there is None:
                if not target.startswith("generated/"):
                    faults.append(f"{path}:{number}: \"{target}\" does not start at the root of the "
                                  "repository")
            elif there != home and there not in MAY_USE[home]:
                faults.append(f"{path}:{number}: {home} may not include {there}")


def main():
    files = subprocess.run(["git", "ls-files", "--", "*.h", "*.cpp"], check=True, text=True,
                           capture_output=True).stdout.split()
    faults = []
    for path in files:
        if not path.startswith("tests/") and folder_of(path):
            check(path, faults)
    print("\n".join(faults) if faults else f"layers: {len(files)} files in order")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
