#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs Plumbline, mrcal and OpenCV in turn on the same corners and prints medians and ratios."""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def plumbline(binary, session, work, *options):
    """One run: its own account of the stages, and the process's from the operating system."""
    out = os.path.join(work, "result")
    command = ["/usr/bin/time", "-f", "%U %S %M", binary, "calibrate", session, "--out", out,
               "--threads", "1", "--no-report", *options]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{run.stderr}")
    user, system, peak_kb = run.stderr.strip().splitlines()[-1].split()
    with open(os.path.join(out, "calibration.json"), encoding="utf-8") as file:
        stages = json.load(file)["stages"]
    return {"cpu_s": float(user) + float(system), "peak_mb": int(peak_kb) / 1024, "stages": stages}


def rival(tool, session, stride):
    run = subprocess.run([os.path.join(HERE, "rivals.py"), tool, session, "--stride", str(stride)],
                         capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"{tool} failed:\n{run.stderr}")
    return json.loads(run.stdout.strip().splitlines()[-1])


def solve_seconds(run, stage):
    seconds = run["stages"][stage]["seconds"]
    return seconds["initialise"] + seconds["solve"]


def median_of(runs, figure):
    return statistics.median(figure(run) for run in runs)


class Table:
    def __init__(self):
        self.rows = []

    def add(self, *cells):
        self.rows.append(cells)

    def show(self):
        head = ("recording", "work", "tool", "RMSE [px]", "seconds", "peak [MB]",
                "rival / Plumbline")
        for row in (head, tuple("---" for _ in head), *self.rows):
            print("| " + " | ".join(str(cell) for cell in row) + " |")


def mono(table, name, session, options, strides):
    """One camera from scratch, squared error: the same corners, the same optimum."""
    for stride, tools in strides:
        ours, theirs = [], {tool: [] for tool in tools}
        for _ in range(options.runs):
            ours.append(plumbline(options.plumbline, session, options.work, "--only", "cam0",
                                  "--no-imu", "--loss", "none", "--stride", str(stride),
                                  "--min-corners", "8"))
            for tool in tools:
                theirs[tool].append(rival(tool, session, stride))
        own = median_of(ours, lambda run: solve_seconds(run, "camera"))
        stage = ours[0]["stages"]["camera"]
        work = f"one camera, {stage['views_used']} views"
        table.add(name, work, "Plumbline", f"{stage['rmse_px']:.7f}", f"{own:.3f}",
                  f"{median_of(ours, lambda run: run['peak_mb']):.0f}", "1")
        for tool, runs in theirs.items():
            seconds = median_of(runs, lambda run: run["seed_s"] + run["solve_s"])
            table.add(name, f"one camera, {runs[0]['views']} views", tool,
                      f"{runs[0]['rmse_px']:.7f}", f"{seconds:.3f}",
                      f"{median_of(runs, lambda run: run['peak_mb']):.0f}", f"{seconds / own:.1f}")


def whole(table, name, session, options):
    """The work of an evening, whole process: load, stereo cameras, camera-IMU."""
    camchain = os.path.join(session, "kalibr", "camchain-imucam.yaml")
    jobs = [("stereo cameras, no loss", ["--no-imu", "--loss", "none"]),
            ("stereo cameras, Cauchy", ["--no-imu"])]
    if os.path.exists(camchain):
        jobs += [("camera-IMU, given cameras, no loss", ["--cameras", camchain, "--loss", "none"]),
                 ("camera-IMU, given cameras, Cauchy", ["--cameras", camchain])]
    else:
        jobs += [("cameras and camera-IMU, no loss", ["--loss", "none"]),
                 ("cameras and camera-IMU, Cauchy", [])]
    for work, arguments in jobs:
        runs = [plumbline(options.plumbline, session, options.work, *arguments)
                for _ in range(options.runs)]
        stages = runs[0]["stages"]
        stage = stages.get("camera_imu") or stages["camera"]
        table.add(name, f"{work}; whole process, CPU", "Plumbline", f"{stage['rmse_px']:.7f}",
                  f"{median_of(runs, lambda run: run['cpu_s']):.3f}",
                  f"{median_of(runs, lambda run: run['peak_mb']):.0f}", "1")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plumbline", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--quick", action="store_true", help="one run of each, mrcal only")
    parser.add_argument("sessions", nargs="+", help="NAME=FOLDER")
    options = parser.parse_args()
    options.runs = 1 if options.quick else 5
    model = re.search(r"model name\s*:\s*(.*)", open("/proc/cpuinfo", encoding="utf-8").read())
    print(f"{model.group(1) if model else 'unknown processor'}, {os.cpu_count()} processors, one "
          f"thread used; medians of {options.runs} runs\n")
    table = Table()
    for session in options.sessions:
        name, folder = session.split("=", 1)
        strides = [(1, ["mrcal"])] if options.quick else [(1, ["mrcal"]), (12, ["mrcal", "opencv"])]
        mono(table, name, folder, options, strides)
        whole(table, name, folder, options)
    table.show()


if __name__ == "__main__":
    main()
