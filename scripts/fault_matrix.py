#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which faults of a recording does `plumbline calibrate` find, name, and survive?

fault_matrix.py PLUMBLINE [--rigs euroc,tumvi,d435i] [--seeds 1,2,3] [--duration 30] [--faults SPEC ...]

Simulates a recording for every fault, rig and seed, calibrates it as if it were real, and prints one row of
Markdown each: error of T_SC0's translation in millimetres and in shown deviations (the largest component),
what the score tests name, and the verdict. The last lines count results that are called good and are off by
more than five deviations.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

# Spec of the fault, and the words (of stages.camera_imu.faults) that name it; empty: not tested for.
FAULTS = {
    "": [],
    "accel-scale=1.01": ["accel-scale"],
    "accel-scale=1.02,z": ["accel-scale"],
    "gyro-scale=1.01": ["gyro-scale"],
    "accel-misalignment=1deg": ["accel-misalignment", "gyro-misalignment"],
    "gyro-misalignment=1deg": ["accel-misalignment", "gyro-misalignment"],
    "g-sensitivity=0.002": ["g-sensitivity"],
    "accel-delay=5ms": ["imu-delay"],
    "gyro-delay=5ms": ["imu-delay"],
    "gyro-delay=20ms": ["imu-delay"],
    "clock-drift=100ppm": ["clock-drift"],
    "clock-step=5ms@10s": ["clock-step"],
    "slip=0.2deg@15s": ["imu-moved"],
    "bump=0.1deg@15s": ["camera-moved"],
    "exposure-shift=1.5ms,cam1": ["camera-delay"],
    "rolling-shutter=10ms": ["line-delay"],
    "wrong-size=0.9%": ["target-size"],
    "clip=12": [],
    "spike=10/min,100rad/s": [],
    "bias-jump=0.05@12s": [],
    "vibration=2m/s2,40Hz": [],
    "jitter=1ms": [],
    "false-corners=2%": [],
    "swapped-ids=1%": [],
    "bow=1mm": [],
    "sway=10mm,0.5Hz": [],
    "moved-target=5mm@15s": [],
}


def run(command):
    return subprocess.run(command, check=False, text=True, capture_output=True)


def calibrated(program, fault, rig, seed, duration, folder):
    """calibration.json and truth.json of one recording; the last line of a refusal in place of the first."""
    session, out = folder / "session", folder / "out"
    words = ["--fault", fault] if fault else []
    run([program, "simulate", "--out", session, "--rig", rig, "--seed", str(seed), "--duration", str(duration),
         *words]).check_returncode()
    done = run([program, "calibrate", session, "--out", out])
    truth = json.loads((session / "truth" / "truth.json").read_text())
    if done.returncode != 0:
        return None, truth, done.stderr.strip().splitlines()[-1]
    return json.loads((out / "calibration.json").read_text()), truth, ""


def lever_arm_error(result, truth):
    """Norm of the error [mm], and its largest component in shown deviations."""
    estimate = [row[3] for row in result["imu"]["T_SC0"][:3]]
    true = [row[3] for row in truth["imu"]["T_SC0"][:3]]
    errors = [a - b for a, b in zip(estimate, true)]
    sigmas = [abs(e) / s for e, s in zip(errors, result["imu"]["T_SC0_std"])]
    return 1e3 * sum(e * e for e in errors) ** 0.5, max(sigmas)


def row(program, fault, rig, seed, duration):
    with tempfile.TemporaryDirectory() as folder:
        result, truth, refusal = calibrated(program, fault, rig, seed, duration, Path(folder))
    if result is None:
        return {"fault": fault, "rig": rig, "seed": seed, "verdict": "refused", "named": refusal.split("; ")[0]}
    faults = result["stages"]["camera_imu"].get("faults", {})
    named = [cause["fault"] for cause in faults.get("causes", [])]
    if "alternative" in faults:
        named[0] += " or " + faults["alternative"]["fault"]
    millimetres, sigmas = lever_arm_error(result, truth)
    return {"fault": fault, "rig": rig, "seed": seed, "mm": millimetres, "sigmas": sigmas,
            "named": ", ".join(named), "verdict": result["verdict"]["level"],
            "right": any(word in named[0] for word in FAULTS.get(fault, [])) if named else False}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plumbline")
    parser.add_argument("--rigs", default="euroc,tumvi,d435i")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--duration", type=float, default=30)
    parser.add_argument("--faults", nargs="*", default=list(FAULTS))
    options = parser.parse_args()
    rows = []
    print("| fault | rig | seed | error [mm] | in deviations | first named | verdict |")
    print("|---|---|---|---|---|---|---|")
    for fault in options.faults:
        for rig in options.rigs.split(","):
            for seed in options.seeds.split(","):
                r = row(options.plumbline, fault, rig, seed, options.duration)
                rows.append(r)
                error = f"{r['mm']:.2f} | {r['sigmas']:.1f}" if "mm" in r else "- | -"
                name = f"`{fault}`" if fault else "none"
                print(f"| {name} | {rig} | {seed} | {error} | {r['named']} | {r['verdict']} |", flush=True)
    tested = [r for r in rows if FAULTS.get(r["fault"]) and "mm" in r]
    wrong = [r for r in rows if r["verdict"] == "good" and r.get("sigmas", 0) > 5]
    print(f"\n{sum(r['right'] for r in tested)} of {len(tested)} faults that are tested for were named first; "
          f"{len(wrong)} of {len(rows)} results are called good and off by more than 5 deviations.")


if __name__ == "__main__":
    main()
