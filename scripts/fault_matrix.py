#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which faults of a recording does `plumbline calibrate` find, name, and survive?

fault_matrix.py PLUMBLINE [--rigs euroc,mono,tumvi] [--seeds 1,2,3] [--duration 30] [--kinds KIND ...]
                [--sizes 1,2,3] [--bar 90] [--effect 3] [--jobs 2] [--rows FILE.json] [--docs docs/faults.md]

Simulates a recording for every fault in three sizes, every rig and every seed, calibrates it as if it were
real, and prints a Markdown table with one row for each fault and size. Errors are those of T_SC0 and of the
time offset in shown deviations, the largest component; `mono` is euroc without its second camera. --docs puts
the table between the marks of that file. Exit code 1 where the bar is missed: at least 90 % (--bar) of the faults
that move the result by more than three (--effect) of its shown deviations, or end in a refusal, named as
themselves or as "one of these two", and no result called good that is off by more than five of them and a floor
of 0.5 mm, 0.02 degrees, or 0.05 ms.
"""
import argparse
import json
import math
import shutil
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Specs in three sizes and the words that name them rightly.
FAULTS = {
    "none": ([""], []),
    "accel-scale": (["accel-scale=1.003", "accel-scale=1.01,z", "accel-scale=1.1"], ["accel-scale", "gravity"]),
    "gyro-scale": (["gyro-scale=1.003", "gyro-scale=1.01,y", "gyro-scale=1.03"], ["gyro-scale"]),
    "accel-misalignment": ([f"accel-misalignment={a}deg" for a in (0.3, 1, 3)],
                           ["accel-misalignment", "gyro-misalignment"]),
    "gyro-misalignment": ([f"gyro-misalignment={a}deg" for a in (0.3, 1, 3)],
                          ["accel-misalignment", "gyro-misalignment"]),
    "axes": ([f"axes={a}deg" for a in (0.3, 1, 3)], ["accel-misalignment", "gyro-misalignment"]),
    "accel-delay": ([f"accel-delay={t}ms" for t in (2, 5, 20)], ["imu-delay"]),
    "gyro-delay": ([f"gyro-delay={t}ms" for t in (2, 5, 20)], ["imu-delay"]),
    "g-sensitivity": ([f"g-sensitivity={g}" for g in (0.0005, 0.002, 0.01)], ["g-sensitivity"]),
    "vibration": (["vibration=1m/s2,30Hz", "vibration=2m/s2,40Hz", "vibration=10m/s2,70Hz"], ["density"]),
    "slip": ([f"slip={a}deg@15s" for a in (0.1, 0.2, 1)], ["imu-moved"]),
    "bias-jump": ([f"bias-jump={j}@12s" for j in (0.01, 0.05, 0.2)], ["gyro-bias-jump"]),
    "accel-bias-jump": ([f"accel-bias-jump={j}@12s" for j in (0.1, 0.5, 2)], ["accel-bias-jump"]),
    "clip": ([f"clip={a}" for a in (13, 12, 11)], ["clip"]),
    "clip-gyro": ([f"clip-gyro={a}" for a in (1.2, 1, 0.8)], ["clip"]),
    "spike": (["spike=10/min,2rad/s", "spike=10/min,20rad/s", "spike=10/min,100rad/s"], ["spike"]),
    "accel-spike": (["accel-spike=10/min,20m/s2", "accel-spike=10/min,100m/s2", "accel-spike=10/min,500m/s2"],
                    ["spike"]),
    "gap": (["gap=0.1s@12s", "gap=0.5s@12s", "gap=3s@12s"], ["gap"]),
    "clock-drift": ([f"clock-drift={d}ppm" for d in (50, 200, 1000)], ["clock-drift"]),
    "clock-step": ([f"clock-step={t}ms@10s" for t in (2, 5, 20)], ["clock-step"]),
    "burst": ([f"burst={n}" for n in (2, 5, 10)], ["burst"]),
    "bump": ([f"bump={a}deg@15s" for a in (0.05, 0.1, 0.5)], ["camera-moved"]),
    "exposure-shift": ([f"exposure-shift={t}ms,cam1" for t in (0.5, 1.5, 5)], ["camera-delay"]),
    "rolling-shutter": ([f"rolling-shutter={t}ms" for t in (5, 10, 20)], ["line-delay"]),
    "blur": ([f"blur={t}ms" for t in (5, 10, 20)], []),
    "bow": ([f"bow={h}mm" for h in (0.5, 1, 3)], ["target-shape"]),
    # A board that is longer one way has another mean size, too: the shape is estimated, and the size is named.
    "stretch": ([f"stretch={s}%" for s in (0.2, 0.5, 2)], ["target-shape", "target-size"]),
    "sway": (["sway=3mm,0.5Hz", "sway=10mm,0.5Hz", "sway=10mm,1.3Hz"], ["target-sways"]),
    "moved-target": ([f"moved-target={d}mm@15s" for d in (2, 5, 20)], ["target-moved"]),
    "wrong-size": ([f"wrong-size={s}%" for s in (0.5, 0.9, 5)], ["target-size"]),
    "jitter": ([f"jitter={t}ms" for t in (0.5, 1, 3)], ["stamps-wander", "stamps-jitter"]),
    "restamp": ([f"restamp={s}%" for s in (0.2, 0.5, 1)], ["stamps-wander", "clock-step", "clock-drift"]),
    "false-corners": ([f"false-corners={s}%" for s in (2, 5, 10)], ["false-corners"]),
    "swapped-ids": ([f"swapped-ids={s}%" for s in (0.1, 0.5, 1)], ["swapped-ids"]),
    "frozen": ([f"frozen={n}/min" for n in (5, 20, 60)], ["frozen"]),
    "column-shutter": ([f"column-shutter={t}ms" for t in (3, 10, 20)], ["column-delay"]),
    "soft-mount": ([f"soft-mount={a}deg" for a in (0.003, 0.01, 0.02)], ["soft-mount"]),
}
# What rules of the verdict and refusals name.
RULES = {"Spikes of the IMU": "spike", "Gaps in the IMU's samples": "gap", "Views delivered twice": "frozen",
         "Tags with another's id": "swapped-ids", "False corners": "false-corners",
         "Readings at the end of the sensor's range": "clip", "Jitter of the frames' stamps": "stamps-jitter",
         "Noise density of the accelerometer": "density"}
REFUSALS = {"stamped in bursts": "burst", "estimated gravity is": "gravity",
            "offset between gyroscope and cameras is not constant": "stamps-wander",
            "disagree about scale": "target-size", "cut off": "clip",
            "jump of the gyroscope's bias": "gyro-bias-jump", "jump of the accelerometer's bias": "accel-bias-jump",
            "changes of the time offset": "stamps-wander", "step of the time offset": "clock-step",
            "drift of the IMU's clock": "clock-drift"}
FLOOR = {"mm": 0.5, "deg": 0.02, "ms": 0.05}
START, END = "<!-- fault matrix: begin -->", "<!-- fault matrix: end -->"


def run(command):
    return subprocess.run([str(c) for c in command], check=False, text=True, capture_output=True)


def calibrated(program, fault, rig, seed, duration, folder):
    """calibration.json and truth.json of one recording; the last line of a refusal in place of the first."""
    session, out = folder / "session", folder / "out"
    words = ["--fault", fault] if fault else []
    run([program, "simulate", "--out", session, "--rig", "euroc" if rig == "mono" else rig, "--seed", seed,
         "--duration", duration, *words]).check_returncode()
    if rig == "mono":
        shutil.rmtree(session / "mav0" / "cam1")
    done = run([program, "calibrate", session, "--out", out, "--threads", 1, "--no-report"])
    truth = json.loads((session / "truth" / "truth.json").read_text())
    if done.returncode != 0:
        return None, truth, done.stderr.strip().splitlines()[-1]
    return json.loads((out / "calibration.json").read_text()), truth, ""


def shown_std(result):
    """Deviations of T_SC0 and the offset, by which the verdict judges: the larger of formal and cluster-robust."""
    formal = [*result["imu"]["T_SC0_std"], result["imu"]["time_offset_std_s"]]
    return [max(pair) for pair in zip(formal, result["stages"]["camera_imu"].get("robust_std", formal))]


def errors(result, truth):
    """Sizes of the errors, and the largest component in shown deviations beyond the floor and at all."""
    A, B = result["imu"]["T_SC0"], truth["imu"]["T_SC0"]
    moved = [a[3] - b[3] for a, b in zip(A[:3], B[:3])]
    R = [[sum(A[i][k] * B[j][k] for k in range(3)) for j in range(3)] for i in range(3)]  # A B'
    turned = [0.5 * (R[2][1] - R[1][2]), 0.5 * (R[0][2] - R[2][0]), 0.5 * (R[1][0] - R[0][1])]
    offset = result["imu"]["time_offset_s"] - truth["imu"]["time_offset_s"]
    size = {"mm": 1e3 * math.hypot(*moved), "deg": math.degrees(math.hypot(*turned)), "ms": 1e3 * abs(offset)}
    std = shown_std(result)
    sigmas = {"mm": max(abs(e) / s for e, s in zip(moved, std[:3])),
              "deg": max(abs(e) / s for e, s in zip(turned, std[3:6])),
              "ms": abs(offset) / std[6]}
    beyond = max((s for key, s in sigmas.items() if size[key] > FLOOR[key]), default=0)
    return size, max(sigmas.values()), beyond


def names(result):
    """What is named: the first cause and its alternative, and what the rules say of samples and views."""
    faults = result["stages"]["camera_imu"].get("faults", {})
    named = [cause["fault"] for cause in faults.get("causes", [])[:1]]
    if "alternative" in faults:
        named.append(faults["alternative"]["fault"])
    worse = [f["rule"] for f in result["verdict"]["findings"] if f["level"] != "good"]
    return named + [word for rule, word in RULES.items() if rule in worse]


def row(options, kind, fault, rig, seed):
    with tempfile.TemporaryDirectory() as folder:
        result, truth, refusal = calibrated(options.plumbline, fault, rig, seed, options.duration, Path(folder))
    out = {"kind": kind, "fault": fault, "rig": rig, "seed": seed}
    if result is None:
        named = [word for text, word in REFUSALS.items() if text in refusal]
        return out | {"verdict": "refused", "named": named, "refusal": refusal}
    size, sigmas, beyond = errors(result, truth)
    return out | {"verdict": result["verdict"]["level"], "named": names(result), "mm": size["mm"],
                  "sigmas": sigmas, "beyond": beyond}


def is_named(r):
    return any(word in FAULTS[r["kind"]][1] for word in r["named"])


def has_effect(r, least):
    """Moves the result by more than so many of its deviations, or ends in a refusal; and can be named at all."""
    return bool(FAULTS[r["kind"]][1]) and r.get("sigmas", math.inf) > least


def is_silently_wrong(r):
    return r["verdict"] == "good" and r["beyond"] > 5


def table(rows, bar, least):
    lines = ["| fault | found | named | error [mm] | in deviations | good, caution, bad, refused |",
             "|---|---|---|---|---|---|"]
    for fault in dict.fromkeys(r["fault"] for r in rows):
        these = [r for r in rows if r["fault"] == fault]
        known = [r for r in these if "mm" in r]
        error = f"{statistics.median(r['mm'] for r in known):.2f}" if known else "-"
        sigmas = f"{max(r['sigmas'] for r in known):.1f}" if known else "-"
        found = sum(r["verdict"] != "good" for r in these)
        levels = [sum(r["verdict"] == level for r in these) for level in ("good", "caution", "bad", "refused")]
        lines.append(f"| {f'`{fault}`' if fault else 'none'} | {found}/{len(these)} | "
                     f"{sum(map(is_named, these))}/{len(these)} | {error} | {sigmas} | {', '.join(map(str, levels))} |")
    effect = [r for r in rows if has_effect(r, least)]
    wrong = [r for r in rows if is_silently_wrong(r)]
    share = 100 * sum(map(is_named, effect)) / max(1, len(effect))
    lines += ["", f"Of {len(rows)} recordings, {len(effect)} are moved by more than {least:g} of their shown deviations, "
              f"or refused: {share:.0f} % of these are named. {len(wrong)} are called good and off by more than five."]
    return "\n".join(lines), share >= bar and not wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plumbline")
    parser.add_argument("--rigs", default="euroc,mono,tumvi")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--duration", type=float, default=30)
    parser.add_argument("--kinds", nargs="*", default=list(FAULTS))
    parser.add_argument("--sizes", default="1,2,3", help="which of each fault's sizes")
    parser.add_argument("--bar", type=float, default=90, help="least share that is to be named [%%]")
    parser.add_argument("--effect", type=float, default=3, help="in shown deviations; faults below need no name")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rows", help="every recording's row, as JSON")
    parser.add_argument("--docs", help="file whose table is replaced")
    options = parser.parse_args()
    sizes = {int(size) - 1 for size in options.sizes.split(",")}
    cases = [(kind, fault, rig, seed) for kind in options.kinds
             for k, fault in enumerate(FAULTS[kind][0]) if k in sizes or kind == "none"
             for rig in options.rigs.split(",") for seed in options.seeds.split(",")
             if not (rig == "mono" and kind in ("bump", "exposure-shift"))]
    with ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(lambda case: row(options, *case), cases))
    text, passed = table(rows, options.bar, options.effect)
    print(text)
    for r in rows:
        if (has_effect(r, options.effect) and not is_named(r)) or is_silently_wrong(r):
            print(f"missed: {r}", file=sys.stderr)
    if options.rows:
        Path(options.rows).write_text(json.dumps(rows, indent=1))
    if options.docs:
        page = Path(options.docs).read_text()
        before, rest = page.split(START)
        Path(options.docs).write_text(f"{before}{START}\n{text}\n{END}{rest.split(END)[1]}")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
