#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs Plumbline, mrcal and OpenCV in turn on the same corners, one thread each, and prints two
tables in Markdown: everything that was measured, and the measured figures against the bars.

Work [s]: Plumbline's are wall seconds of "initialise" and "solve" in calibration.json; the rivals'
are CPU seconds of seeding and solving. The ratio compares these CPU seconds of the rival with
Plumbline's whole process, start, reading and writing included: it errs on the rival's side, and a
busy machine does not bend it.
"""
import argparse
import datetime
import os
import platform
import re
import sys
import tempfile

import sessions
from runs import calibrate, measured, median, rival, stage_seconds
from tables import Bars, Table

# The machine on which the bars in seconds were set needs so long for mrcal's work on one camera of
# EuRoC's recording, all views. The same bars as parts of that hold on any machine, fast or slow.
BARS_MRCAL_S = {"EuRoC": 4.3}
# What the rivals solve: one stated lens model, the even board, no second solutions of halves. In
# Plumbline's own rows too, so that they are of one problem.
MODELS = ["--models", "pinhole-radtan"]  # given cameras have their own
AS_RIVALS = ["--target-shape", "flat", "--no-halves"]
MONO = ["--only", "cam0", "--no-imu", "--loss", "none", "--min-corners", "8"]


class Benchmark:
    def __init__(self, options):
        self.options = options
        self.runs = 1 if options.quick else 5
        self.rival_runs = 1 if options.quick else 3
        self.table = Table("recording", "work", "tool", "RMSE [px]", "work [s]",
                           "process CPU [s]", "process wall [s]", "peak [MB]", "× Plumbline")
        self.bars = Bars()
        self.mrcal_s = {}  # by recording: mrcal's work on one camera, all views

    def plumbline(self, session, *arguments, report=False):
        models = [] if "--cameras" in arguments else MODELS
        return [calibrate(self.options.plumbline, session, self.options.work, *models, *AS_RIVALS,
                          *arguments, report=report) for _ in range(self.runs)]

    def add(self, name, work, tool, rmse, seconds, runs, ratio=""):
        print(f"{name}: {work}: {tool}", file=sys.stderr)
        self.table.add(name, work, tool, "" if rmse is None else f"{rmse:.7f}",
                       "" if seconds is None else f"{seconds:.3f}",
                       *(f"{median(runs, key):.2f}" for key in ("cpu_s", "wall_s")),
                       f"{median(runs, 'peak_mb'):.0f}", ratio)

    def mono(self, name, session, tools, what):
        """One camera from scratch, squared error: the same corners, the same optimum."""
        own = self.plumbline(session, *MONO)
        seconds = median(own, lambda run: stage_seconds(run, "camera"))
        whole = median(own, "cpu_s")
        stage = own[0]["stages"]["camera"]
        work = f"one camera, no loss, {what} ({stage['views_used']} views)"
        self.add(name, work, "Plumbline", stage["rmse_px"], seconds, own, "1")
        for tool in tools:
            theirs = [rival(tool, session) for _ in range(self.rival_runs)]
            total = median(theirs, lambda run: run["seed_cpu_s"] + run["solve_cpu_s"])
            work = f"one camera, no loss, {what} ({theirs[0]['views']} views)"
            self.add(name, work, tool, theirs[0]["rmse_px"], total, theirs,
                     f"{total / whole:.0f}")
            if tool == "mrcal":
                self.mrcal_s.setdefault(name, total)
            if tool == "mrcal" and len(tools) == 1:  # on a few frames Plumbline's start dominates
                self.bars.at_most(name, f"one camera, {what}: Plumbline's whole CPU / mrcal's work",
                                  whole / total, 0.1, "")

    def seconds_at_most(self, name, what, measured, bar):
        """A bar in seconds; where the bars' machine is known, also as a part of mrcal's time."""
        self.bars.at_most(name, what, measured, bar, "s")
        if name in BARS_MRCAL_S:
            part = f"(bar: {bar:g} s / {BARS_MRCAL_S[name]:g} s)"
            self.bars.at_most(name, f"the same / mrcal's work on one camera, all views {part}",
                              measured / self.mrcal_s[name], round(bar / BARS_MRCAL_S[name], 4), "")

    def stage(self, name, session, stage, work, arguments):
        """One job without loss and with the default loss; returns the runs of both."""
        both = []
        for loss, extra in (("no loss", ["--loss", "none"]), ("Cauchy", [])):
            runs = self.plumbline(session, *arguments, *extra)
            self.add(name, f"{work}, {loss}", "Plumbline", runs[0]["stages"][stage]["rmse_px"],
                     median(runs, lambda run: stage_seconds(run, stage)), runs)
            both.append(runs)
        return both

    def stereo(self, name, session):
        squared, robust = self.stage(name, session, "camera", "all cameras", ["--no-imu"])

        def seconds(runs, *parts):
            return median(runs, lambda run: stage_seconds(run, "camera", *parts))

        self.seconds_at_most(name, "camera batch: start and solve, no loss", seconds(squared), 0.3)
        self.bars.at_most(name, "the same, Cauchy, as multiple of it",
                          seconds(robust) / seconds(squared), 3, "×")
        self.bars.without(name, "start, solve and covariance, no loss",
                          seconds(squared, "initialise", "solve", "covariance"), "s")
        self.bars.at_most(name, "peak of the process, no loss", median(squared, "peak_mb"), 100,
                          "MB")

    def camera_imu(self, name, session):
        cameras = sessions.given_cameras(session)
        squared, robust = self.stage(name, session, "camera_imu", "camera-IMU, given cameras",
                                     ["--cameras", cameras])

        def seconds(runs, *parts):
            return median(runs, lambda run: stage_seconds(run, "camera_imu", "load", "initialise",
                                                          "solve", *parts))

        self.seconds_at_most(name, "camera-IMU batch with loading: load, start and solve, no loss",
                             seconds(squared), 0.5)
        self.bars.at_most(name, "the same, Cauchy, as multiple of it",
                          seconds(robust) / seconds(squared), 3, "×")
        self.bars.without(name, "load, start, solve and covariance, no loss",
                          seconds(squared, "covariance"), "s")
        self.bars.at_most(name, "peak of the process, no loss", median(squared, "peak_mb"), 100,
                          "MB")
        both, _ = self.stage(name, session, "camera_imu", "cameras from scratch, then camera-IMU",
                             [])
        self.bars.at_most(name, "peak of both stages in one process, no loss",
                          median(both, "peak_mb"), 100, "MB")

    def report(self, name, session):
        """Seconds that the page costs: within calibrate, and made again from the records."""
        without = self.plumbline(session)
        with_page = self.plumbline(session, report=True)
        page = os.path.join(self.options.work, "page.html")
        again = [measured([self.options.plumbline, "report",
                           os.path.join(self.options.work, "result"), "--out", page,
                          "--force"])[1]
                 for _ in range(self.runs)]
        self.add(name, "both stages, Cauchy, report.html", "Plumbline", None, None, with_page)
        self.add(name, "plumbline report, from the records", "Plumbline", None, None, again)
        self.bars.at_most(name, "report.html within calibrate, CPU",
                          median(with_page, "cpu_s") - median(without, "cpu_s"), 3, "s")
        self.bars.at_most(name, "plumbline report, whole process, CPU", median(again, "cpu_s"), 3,
                          "s")

    def detection(self, name, session):
        """Images a second on one core: the detector alone, and the whole command."""
        images = sessions.images(session)
        out, _ = measured([self.options.detector_benchmark, *images])
        alone = float(re.search(r"([\d.]+) images a second", out).group(1))
        costs = []
        for _ in range(self.runs):
            with tempfile.TemporaryDirectory(dir=self.options.work) as out:
                costs.append(measured([self.options.plumbline, "detect", session, "--no-cache",
                                       "--threads", "1", "--out", out])[1])
        self.add(name, f"detect {len(images)} images, reading and writing included", "Plumbline",
                 None, None, costs)
        self.bars.at_least(name, "detector alone, images a second and core", alone, 100, "")
        self.bars.without(name, "plumbline detect with reading and writing, images a second of CPU",
                          len(images) / median(costs, "cpu_s"), "")

    def recording(self, name, session):
        self.mono(name, session, ["mrcal"], "all views")
        if not self.options.quick:
            parts = [("24 common tags", sessions.frames_with_common_tags(session), ["mrcal"]),
                     ("every 12th frame", sessions.stamps(session)[::12], ["mrcal", "OpenCV"])]
            for what, stamps, tools in parts:
                folder = os.path.join(self.options.work, f"{name} {what}")
                self.mono(name, sessions.subset(session, set(stamps), folder), tools, what)
        self.stereo(name, session)
        self.camera_imu(name, session)
        self.report(name, session)


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = re.search(r"model name\s*:\s*(.*)", file.read())
    load = ", ".join(f"{value:.2f}" for value in os.getloadavg())
    return (f"{datetime.date.today()}, {model.group(1) if model else platform.machine()}, "
            f"{os.cpu_count()} processors, load average {load}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--plumbline", required=True, help="the program")
    parser.add_argument("--detector-benchmark", required=True, help="the program of that name")
    parser.add_argument("--work", required=True, help="folder for results")
    parser.add_argument("--quick", action="store_true",
                        help="one run of each, no OpenCV, no subsets")
    parser.add_argument("--images", action="append", default=[], metavar="NAME=FOLDER",
                        help="session of images, for the detector")
    parser.add_argument("sessions", nargs="+", metavar="NAME=FOLDER", help="sessions of corners")
    options = parser.parse_intermixed_args()  # --images may stand between sessions
    benchmark = Benchmark(options)
    before = machine()
    for session in options.sessions:
        benchmark.recording(*session.split("=", 1))
    for session in options.images:
        benchmark.detection(*session.split("=", 1))
    print(f"{before} before and {machine().rsplit('average ', 1)[1]} after. One thread; medians of "
          f"{benchmark.runs} runs ({benchmark.rival_runs} of the rivals).\n")
    if os.getloadavg()[1] > 1.5:
        print("The machine was busy: wall seconds are longer than they would be.\n")
    print(benchmark.table.text())
    print()
    print(benchmark.bars.text())


if __name__ == "__main__":
    main()
