# SPDX-License-Identifier: BSD-3-Clause
"""Runs one program under /usr/bin/time and returns what it says and what it cost."""
import json
import os
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


def measured(command):
    """Standard output, and the whole process: CPU (user + system) and wall seconds, peak MB."""
    run = subprocess.run(["/usr/bin/time", "-f", "%U %S %e %M", *command], capture_output=True,
                         text=True, check=False, env={**os.environ, **ONE_THREAD})
    if run.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{run.stderr}")
    user, system, wall, peak_kb = run.stderr.strip().splitlines()[-1].split()
    return run.stdout, {"cpu_s": float(user) + float(system), "wall_s": float(wall),
                        "peak_mb": int(peak_kb) / 1024}


def calibrate(binary, session, work, *options, report=False):
    """One calibration on one thread; `stages` is calibration.json's own account of it."""
    out = os.path.join(work, "result")
    _, cost = measured([binary, "calibrate", session, "--out", out, "--force", "--threads", "1",
                        *([] if report else ["--no-report"]), *options])
    with open(os.path.join(out, "calibration.json"), encoding="utf-8") as file:
        return {**cost, "stages": json.load(file)["stages"]}


def rival(tool, session):
    """One run of rivals.py: its JSON, with what the whole process cost."""
    out, cost = measured([os.path.join(HERE, "rivals.py"), tool, session])
    return {**json.loads(out.strip().splitlines()[-1]), **cost}


def median(runs, figure):
    """Median over runs of run[figure], or of figure(run)."""
    return statistics.median(run[figure] if isinstance(figure, str) else figure(run)
                             for run in runs)


def stage_seconds(run, stage, *parts):
    seconds = run["stages"][stage]["seconds"]
    return sum(seconds[part] for part in parts or ("initialise", "solve"))
