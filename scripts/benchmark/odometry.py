#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The built-in odometry frame by frame: on rendered images, on tracks (without a front end), and on
a real sequence where one is given. One thread; wall time of each frame, images read included, and
the whole process's CPU and peak memory.

    odometry.py --plumbline PROGRAM --work FOLDER [--quick] [NAME=SEQUENCE=CALIBRATION ...]
"""
import argparse
import json
import pathlib
import subprocess

from runs import measured
from tables import Bars, Table


def flight(program, folder, options):
    subprocess.run([program, "simulate", "sequence", "--out", folder, *options], check=True,
                   stdout=subprocess.DEVNULL)
    return folder, folder / "truth/camchain-imucam.yaml", ["--truth",
                                                           folder / "truth/trajectory.csv"]


def run_of(program, sequence, calibration, options, out):
    """The run's record, and the process's CPU seconds and peak [MB]."""
    command = [program, "odometry", sequence, "--calibration", calibration, "--threads", "1",
               "--association", "interpolate", "--force", "--out", out, *options]
    _, cost = measured([str(part) for part in command])
    run = json.loads((out / "odometry.json").read_text())["runs"][0]
    return run, cost["cpu_s"], cost["peak_mb"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--plumbline", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("sequences", nargs="*")
    o = parser.parse_args()
    duration = ["--duration", "6" if o.quick else "20"]
    jobs = {"tracks": flight(o.plumbline, o.work / "odometry_tracks", duration),
            "rendered": flight(o.plumbline, o.work / "odometry_images", duration + ["--images"])}
    for text in o.sequences:
        name, sequence, calibration = text.split("=")
        jobs[name] = (sequence, calibration, [])
    table = Table("odometry, stereo", "frames", "median [ms]", "95 % [ms]", "99 % [ms]",
                  "longest [ms]", "x real time", "CPU [s]", "peak [MB]", "ATE [cm]")
    bars = Bars()
    for name, (sequence, calibration, options) in jobs.items():
        run, cpu, peak = run_of(o.plumbline, sequence, calibration, options,
                                o.work / f"odometry_{name}_out")
        r = run["odometry"]
        table.add(name, r["frames"], *(f"{r[f'frame_{p}_ms']:.1f}"
                                       for p in ("p50", "p95", "p99", "max")),
                  f"{r['real_time_factor']:.1f}", f"{cpu:.1f}", f"{peak:.0f}",
                  f"{100 * run['ate']['translation_m']['rmse']:.2f}")
        if name != "tracks":
            recorded = r["real_time_factor"] * r["seconds"]
            bars.at_least(name, "odometry, stereo, by CPU", recorded / cpu, 3, "x real time")
        bars.at_most(name, "odometry, peak", peak, 300, "MB")
    print(table.text() + "\n\n" + bars.text())


if __name__ == "__main__":
    main()
