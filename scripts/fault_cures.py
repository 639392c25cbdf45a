#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Is a result right, or not called good, after the cure that `plumbline calibrate` prints was applied?

fault_cures.py PLUMBLINE [--rigs euroc,tumvi] [--seeds 1,2] [--duration 30] [--jobs 2] [--faults SPEC ...]

Simulates recordings with faults, calibrates, does to the files what the advice of the first cause or refusal
says (with the figures that it names), and calibrates again. Prints a Markdown table; exit code 1 where a cured
recording is called good and is off by more than five of its shown deviations and the floors of fault_matrix.py.
"""
import argparse
import csv
import json
import math
import re
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fault_matrix import errors, run

FAULTS = ["accel-scale=1.01", "accel-scale=1.02,z", "accel-scale=1.1", "gyro-scale=1.01", "accel-misalignment=1deg",
          "gyro-misalignment=1deg", "axes=3deg", "g-sensitivity=0.002", "accel-delay=5ms", "gyro-delay=20ms",
          "clock-drift=200ppm", "clock-step=5ms@15s", "slip=0.2deg@15s", "bias-jump=0.05@15s",
          "accel-bias-jump=0.5@15s", "bump=0.1deg@15s", "exposure-shift=1.5ms,cam1", "wrong-size=0.9%",
          "wrong-size=10%", "moved-target=5mm@15s", "false-corners=10%", "swapped-ids=1%", "burst=5",
          "spike=10/min,100rad/s", "vibration=10m/s2,70Hz", "gap=0.5s@12s", "rolling-shutter=20ms", "bow=1mm"]


class Samples:
    """imu0/data.csv, to be changed and written back."""

    def __init__(self, session):
        self.path = session / "mav0" / "imu0" / "data.csv"
        with self.path.open() as file:
            self.head, *rows = list(csv.reader(file))
        self.rows = [[int(r[0])] + [float(x) for x in r[1:]] for r in rows]

    def each(self, change):
        self.rows = [change(r) for r in self.rows]
        self.write()

    def write(self):
        with self.path.open("w") as file:
            file.write(",".join(self.head) + "\n")
            for r in self.rows:
                file.write(f"{r[0]}," + ",".join(repr(x) for x in r[1:]) + "\n")


def inverse(M):
    (a, b, c), (d, e, f), (g, h, i) = M
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return [[(e * i - f * h) / det, (c * h - b * i) / det, (b * f - c * e) / det],
            [(f * g - d * i) / det, (a * i - c * g) / det, (c * d - a * f) / det],
            [(d * h - e * g) / det, (b * g - a * h) / det, (a * e - b * d) / det]]


def times(M, v):
    return [sum(m * x for m, x in zip(row, v)) for row in M]


def scaled(session, first, estimate):
    Samples(session).each(lambda r: r[:first] + [r[first + k] / (1 + estimate[k]) for k in range(3)] + r[first + 3:])


def aligned(session, first, e):
    M = inverse([[1, e[0], e[1]], [e[2], 1, e[3]], [e[4], e[5], 1]])
    Samples(session).each(lambda r: r[:first] + times(M, r[first:first + 3]) + r[first + 3:])


def desensitised(session, e):
    G = [e[0:3], e[3:6], e[6:9]]
    Samples(session).each(lambda r: [r[0]] + [w - g for w, g in zip(r[1:4], times(G, r[4:7]))] + r[4:7])


def accelerometer_shifted(session, delay):
    """The accelerometer's readings at the stamp plus the delay, by linear interpolation."""
    samples = Samples(session)
    rows, k, out = samples.rows, 0, []
    for r in rows:
        t = r[0] + 1e9 * delay
        while k + 2 < len(rows) and rows[k + 1][0] < t:
            k += 1
        a, b = rows[k], rows[k + 1]
        s = (t - a[0]) / (b[0] - a[0])
        if 0 <= s <= 1:
            out.append(r[:4] + [x + s * (y - x) for x, y in zip(a[4:7], b[4:7])])
    samples.rows = out
    samples.write()


def first_frame(session):
    """Stamp of camera 0's first frame, where the clocks of a recording that drifts agree."""
    return int((session / "mav0" / "cam0" / "data.csv").read_text().splitlines()[1].split(",")[0])


def undrifted(session, drift):
    begin = first_frame(session)
    Samples(session).each(lambda r: [r[0] - round(drift * (r[0] - begin))] + r[1:])


def spread(session):
    """Stamps of a burst evenly over the time since the last stamp of the one before."""
    samples = Samples(session)
    bursts = [[]]
    for r in samples.rows:
        if bursts[-1] and r[0] - bursts[-1][-1][0] > 1_000_000:
            bursts.append([])
        bursts[-1].append(r)
    out = []
    for before, burst in zip(bursts, bursts[1:]):
        from_ns, to_ns = before[-1][0], burst[-1][0]
        out += [[from_ns + round((k + 1) * (to_ns - from_ns) / len(burst))] + r[1:] for k, r in enumerate(burst)]
    samples.rows = out
    samples.write()


def tag_size(session, factor=None, value=None):
    path = session / "target.yaml"
    text = path.read_text()
    stated = float(re.search(r"tagSize:\s*([\d.eE+-]+)", text)[1])
    path.write_text(re.sub(r"tagSize:.*", f"tagSize: {value or stated * factor!r}", text))


def camera_shifted(session, camera, delay):
    folder = session / "mav0" / f"cam{camera}"
    for name in ("data.csv", "corners.csv"):
        lines = (folder / name).read_text().splitlines()
        out = [line if line.startswith("#") else
               f"{int(line.split(',')[0]) + round(1e9 * delay)},{line.split(',', 1)[1]}" for line in lines]
        (folder / name).write_text("\n".join(out) + "\n")


def densities(session, sensor, factor):
    path = session / "imu.yaml"
    key = {"gyroscope": "gyroscope_noise_density", "accelerometer": "accelerometer_noise_density"}[sensor]
    text = path.read_text()
    value = float(re.search(rf"{key}:\s*([\d.eE+-]+)", text)[1])
    path.write_text(re.sub(rf"{key}:.*", f"{key}: {value * factor!r}", text))


def cure(session, result, refusal):
    """Does what the first advice says; returns what was done and further options of calibrate (or None)."""
    if refusal:
        size = re.search(r"([\d.]+) m \(\+-", refusal)
        if "disagree about scale" in refusal and size:
            tag_size(session, value=float(size[1]))
            return "tagSize", []
        if "in bursts" in refusal:
            spread(session)
            return "stamps spread", []
        return "nothing", None
    causes = result["stages"]["camera_imu"].get("faults", {}).get("causes", [])
    if not causes:
        for finding in result["verdict"]["findings"]:
            if finding["level"] == "good":
                continue
            if finding["rule"].startswith("Noise density of the "):
                densities(session, finding["rule"].removeprefix("Noise density of the "), finding["value"])
                return "density raised", []
            if finding["rule"] == "False corners":
                return "--outliers sigma:4", ["--outliers", "sigma:4"]
        return "nothing", None
    first = causes[0]
    e, fault = first["estimate"], first["fault"]
    simple = {"accel-scale": lambda: scaled(session, 4, e), "gyro-scale": lambda: scaled(session, 1, e),
              "accel-misalignment": lambda: aligned(session, 4, e), "gyro-misalignment": lambda: aligned(session, 1, e),
              "g-sensitivity": lambda: desensitised(session, e), "imu-delay": lambda: accelerometer_shifted(session, e[0]),
              "clock-drift": lambda: undrifted(session, e[0]), "target-size": lambda: tag_size(session, factor=1 + e[0]),
              "camera-delay": lambda: camera_shifted(session, first["camera"], e[0])}
    if fault in simple:
        simple[fault]()
        return fault, []
    if "since_ns" in first:
        until = (first["since_ns"] - first_frame(session)) / 1e9 - 0.5
        return f"{fault}: first part", ["--to", f"{until:.3f}"]
    return "nothing", None


def turn(angle):
    """Exp(-angle n) with n = (1, 1, 1) / sqrt(3), about which the simulator turns a triad."""
    c, s = math.cos(angle), math.sin(angle) / math.sqrt(3)
    d = (1 - c) / 3
    return [[c + d, d + s, d - s], [d - s, c + d, d + s], [d + s, d - s, c + d]]


def cured_truth(truth, done):
    """Delay and rotation of one triad against the other are relative: after the accelerometer was corrected for
    a gyroscope that is late or turned (or the other way round), the IMU's clock or frame is the other triad's."""
    imu = truth["imu"]
    for f in truth["faults"]:
        if done == "imu-delay" and f["name"] == "gyro-delay":
            imu["time_offset_s"] += f["value"]
        if {done, f["name"]} == {"accel-misalignment", "gyro-misalignment"}:
            columns = list(zip(*imu["T_SC0"][:3]))
            turned = [times(turn(f["value"]), column) for column in columns]
            imu["T_SC0"][:3] = [list(row) for row in zip(*turned)]
    return truth


def case(options, fault, rig, seed):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        session = folder / "session"
        run([options.plumbline, "simulate", "--out", session, "--rig", rig, "--seed", seed, "--duration",
             options.duration, "--fault", fault]).check_returncode()
        truth = json.loads((session / "truth" / "truth.json").read_text())

        def calibrate(further):
            out = folder / "out"
            shutil.rmtree(out, ignore_errors=True)
            done = run([options.plumbline, "calibrate", session, "--out", out, "--threads", 1, "--no-report", *further])
            if done.returncode != 0:
                return None, done.stderr.strip().splitlines()[-1]
            return json.loads((out / "calibration.json").read_text()), ""

        result, refusal = calibrate([])
        before = result["verdict"]["level"] if result else "refused"
        done, further = cure(session, result, refusal)
        if further is None:
            return {"fault": fault, "rig": rig, "seed": seed, "before": before, "cure": done}
        result, refusal = calibrate(further)
        if result is None:
            return {"fault": fault, "rig": rig, "seed": seed, "before": before, "cure": done, "after": "refused"}
        size, sigmas, beyond = errors(result, cured_truth(truth, done))
        return {"fault": fault, "rig": rig, "seed": seed, "before": before, "cure": done,
                "after": result["verdict"]["level"], "mm": size["mm"], "sigmas": sigmas, "beyond": beyond}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plumbline")
    parser.add_argument("--rigs", default="euroc,tumvi")
    parser.add_argument("--seeds", default="1,2")
    parser.add_argument("--duration", type=float, default=30)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--faults", nargs="*", default=FAULTS)
    options = parser.parse_args()
    cases = [(fault, rig, seed) for fault in options.faults for rig in options.rigs.split(",")
             for seed in options.seeds.split(",")]
    with ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(lambda c: case(options, *c), cases))
    print("| fault | rig | seed | before | cure | after | error [mm] | in deviations |\n|---|---|---|---|---|---|---|---|")
    for r in rows:
        error = f"{r['mm']:.2f} | {r['sigmas']:.1f}" if "mm" in r else "- | -"
        print(f"| `{r['fault']}` | {r['rig']} | {r['seed']} | {r['before']} | {r['cure']} | {r.get('after', '-')} | {error} |")
    wrong = [r for r in rows if r.get("after", "") == "good" and r["beyond"] > 5]
    print(f"\n{len(wrong)} of {len(rows)} recordings are called good after the cure and off by more than five deviations.")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
