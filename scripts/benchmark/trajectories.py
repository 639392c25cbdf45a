#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Absolute trajectory error with SE(3) alignment: Plumbline beside numpy doing what evo does.

evo is not in Debian, so `--reference` is its work in numpy: both files through the csv module, for
each estimated pose the nearest stamp by argmin, Umeyama's alignment, the statistics. It imports
numpy alone (evo also imports scipy and more) and leaves out rotations, both in its favour. All
programs run whole, start and reading included, one after the other in turn; medians are printed.

    trajectories.py --plumbline PROGRAM ESTIMATE TRUTH
    trajectories.py --reference ESTIMATE TRUTH
"""
import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import time

from runs import ONE_THREAD
from tables import Bars, Table

RUNS = 21
MAX_DT = 0.02


def load(path):
    import numpy as np  # only the reference needs it: the driver's own start stays out of the way
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader((line for line in file if not line.startswith("#")), delimiter=" "))
    table = np.array(rows).astype(float)
    return table[:, 0], table[:, 1:4]


def aligned_error(estimate, truth):
    """RMSE [m] and the number of pairs."""
    import numpy as np
    t_estimate, p_estimate = load(estimate)
    t_truth, p_truth = load(truth)
    pairs = []
    for i, stamp in enumerate(t_estimate):
        difference = np.abs(t_truth - stamp)
        j = np.argmin(difference)
        if difference[j] <= MAX_DT:
            pairs.append((i, j))
    i, j = np.array(pairs).T
    x, y = p_estimate[i], p_truth[j]
    mean_x, mean_y = x.mean(axis=0), y.mean(axis=0)
    u, _, vt = np.linalg.svd((y - mean_y).T @ (x - mean_x))
    rotation = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    errors = np.linalg.norm((x - mean_x) @ rotation.T + mean_y - y, axis=1)
    return float(np.sqrt(np.mean(errors ** 2))), len(errors)


def cost(command):
    """CPU (user + system) and wall milliseconds of one process and its peak [MB], and what it said.
    /usr/bin/time counts in steps of 10 ms, too coarse here."""
    start = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, env={**os.environ, **ONE_THREAD}) as run:
        said = run.stdout.read()
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
    if run.returncode != 0:
        sys.exit(f"{' '.join(command)} failed")
    return {"cpu_ms": 1e3 * (usage.ru_utime + usage.ru_stime),
            "wall_ms": 1e3 * (time.perf_counter() - start),
            "peak_mb": usage.ru_maxrss / 1024, "said": said}


def compare(options):
    files = [options.estimate, options.truth]
    commands = {
        "plumbline --version": [options.plumbline, "--version"],
        "plumbline evaluate trajectory": [options.plumbline, "evaluate", "trajectory", *files,
                                          "--json", "-"],
        "evo's work in numpy": [sys.executable, os.path.abspath(__file__), "--reference", *files]}
    runs = {name: [] for name in commands}
    for _ in range(RUNS):
        for name, command in commands.items():
            runs[name].append(cost(command))
    return runs


def rmse_of(run):
    try:
        document = json.loads(run["said"])
    except ValueError:
        return ""
    return f"{document['rmse'] if 'rmse' in document else document['ate']['translation_m']['rmse']:.9f}"


def report(runs):
    table = Table("program", "RMSE [m]", "CPU [ms]", "wall [ms]", "peak [MB]", "× Plumbline (CPU)")
    middle = {name: {key: statistics.median(run[key] for run in measured)
                     for key in ("cpu_ms", "wall_ms", "peak_mb")}
              for name, measured in runs.items()}
    own = middle["plumbline evaluate trajectory"]
    for name, figures in middle.items():
        table.add(name, rmse_of(runs[name][0]), f"{figures['cpu_ms']:.1f}",
                  f"{figures['wall_ms']:.1f}", f"{figures['peak_mb']:.0f}",
                  f"{figures['cpu_ms'] / own['cpu_ms']:.1f}")
    bars = Bars()
    bars.at_most("trajectory", "ATE with alignment, whole process, CPU", own["cpu_ms"], 20, "ms")
    start = middle["plumbline --version"]["cpu_ms"]
    bars.at_most("trajectory", "the same without the program's start, CPU", own["cpu_ms"] - start,
                 20, "ms")
    return f"{table.text()}\n\n{bars.text()}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--plumbline", help="the program")
    parser.add_argument("--reference", action="store_true", help="do evo's work in this process")
    parser.add_argument("estimate")
    parser.add_argument("truth")
    options = parser.parse_args()
    if options.reference:
        rmse, pairs = aligned_error(options.estimate, options.truth)
        print(json.dumps({"rmse": rmse, "n": pairs}))
        return
    if not options.plumbline:
        parser.error("--plumbline PROGRAM is needed")
    print(f"Trajectory error, medians of {RUNS} runs in turn, load average "
          f"{os.getloadavg()[0]:.2f}.\n")
    print(report(compare(options)))


if __name__ == "__main__":
    main()
