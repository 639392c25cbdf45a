#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Is a person faster with the guide? Lets simulated persons of all skills record (`simulate operator
--judge`) with the guide by either criterion, without, and as a dance, and prints the tables of
docs/counterfactuals.md: seconds and views until the projection error against the truth, over the
image, is below 0.1 px, and T_SC0 within 1 mm and 0.05 degrees, and how near the guide's stops are to
the best ones: of the cameras by the error of the recording's own noise, of both stages by the expected error
(stopHindsight(), evaluate/simulation/stop_hindsight.h).

  nice -n 15 scripts/operator_evidence.py --plumbline build/evaluate/plumbline --work FOLDER \\
      [--persons 50] [--rig euroc] [--duration 120] [--first-seed 1] [--only PATTERN] [--table]

Every person makes one recording by every method; methods of one person share their seed. What was
found is kept in --work, one file for each recording, and not made again; recordings are not kept.
Whoever does not get there counts as later than all others.
"""

import argparse
import fnmatch
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

METHODS = {"guided, mi": ["guided", "--criterion", "mi"],
           "guided, predicted-error": ["guided", "--criterion", "predicted-error"],
           "guided, mi, to 0.1 px": ["guided", "--criterion", "mi", "--stop-projection-px", "0.1"],
           "guided, predicted-error, to 0.1 px": ["guided", "--criterion", "predicted-error",
                                                  "--stop-projection-px", "0.1"],
           "guided, mi, IMU to 0.2 px": ["guided", "--criterion", "mi", "--stop-reprojection-px", "0.2"],
           "guided, mi, IMU to 0.1 px": ["guided", "--criterion", "mi", "--stop-reprojection-px", "0.1"],
           "guided, mi, patient": ["guided", "--criterion", "mi", "--patience", "3", "--first-trajectory", "scored",
                                   "--trajectory-s", "5", "--trajectory-amplitude", "1", "--trajectory-roll", "0",
                                   "--trajectory-held-s", "1"],
           "guided, mi, paper": ["guided", "--criterion", "mi", "--patience", "3", "--reached-px", "15", "--reached-s",
                                 "0.5", "--first-trajectory", "scored", "--trajectory-s", "3", "--trajectory-held-s",
                                 "1", "--trajectory-amplitude", "1", "--trajectory-roll", "0"],
           "guided, mi, by pace": ["guided", "--criterion", "mi", "--operator-speed", "0.35"],
           "free": ["free"],
           "dance": ["dance"]}
BARS = {"cameras": 0.6, "camera_imu": 0.7}  # guided over unguided
STOP = 0.15
BOOTSTRAPS = 2000


def quantile(values, p):
    values = sorted(values)
    at = p * (len(values) - 1)
    low = math.floor(at)
    high = min(low + 1, len(values) - 1)
    if values[high] == math.inf:
        return values[low] if at == low else math.inf
    return values[low] + (values[high] - values[low]) * (at - low)


def kept_file(options, name, person):
    made = f"{options.rig}-{options.persons}x{options.duration:g}s-from-{options.first_seed}"
    return pathlib.Path(options.work) / made / name.replace(", ", "-").replace(" ", "_") / f"{person}.json"


def record(options, name, person):
    """Makes one recording and keeps what was found of it."""
    kept = kept_file(options, name, person)
    if kept.exists():
        return
    kept.parent.mkdir(parents=True, exist_ok=True)
    clumsiness = (person - 0.5) / options.persons
    with tempfile.TemporaryDirectory(dir=kept.parent) as folder:
        out = pathlib.Path(folder) / "session"
        command = [options.plumbline, "simulate", "operator", "--rig", options.rig, "--method", *METHODS[name],
                   "--skill", f"{clumsiness:.4f}", "--seed", str(options.first_seed + person - 1), "--duration", str(options.duration),
                   "--judge", "--out", str(out)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        shutil.copy(out / "truth" / "truth.json", kept.with_suffix(".part"))
    kept.with_suffix(".part").rename(kept)


def read(options, name):
    """Person -> document."""
    found = {}
    for person in range(1, options.persons + 1):
        kept = kept_file(options, name, person)
        if kept.exists():
            found[person] = json.loads(kept.read_text())
    return found


def needed(document, stage, what="right_s"):
    value = document["convergence"][stage].get(what)
    return math.inf if value is None else value


def text(value, digits=1):
    return "–" if value == math.inf else f"{value:.{digits}f}"


def quartiles(values, digits=1):
    return " / ".join(text(quantile(values, p), digits) for p in (0.25, 0.5, 0.75))


def ratio(guided, unguided):
    """Of the medians."""
    a, b = quantile(guided, 0.5), quantile(unguided, 0.5)
    return a / b if b < math.inf else math.nan if a == math.inf else 0


def interval(guided, unguided):
    """95 % of the ratio of medians, by a bootstrap over the persons, who are the same in both."""
    chance = random.Random(1)
    drawn = []
    for _ in range(BOOTSTRAPS):
        persons = chance.choices(range(len(guided)), k=len(guided))
        drawn.append(ratio([guided[p] for p in persons], [unguided[p] for p in persons]))
    drawn = [r for r in drawn if not math.isnan(r)]
    return quantile(drawn, 0.025), quantile(drawn, 0.975)


def table(options):
    found = {name: read(options, name) for name in METHODS if fnmatch.fnmatch(name, options.only)}
    found = {name: documents for name, documents in found.items() if documents}
    if not found:
        sys.exit(f"{options.work}: holds no recording of such persons by a method like {options.only}")
    persons = set.intersection(*(set(f) for f in found.values()))
    print(f"{len(persons)} persons, rig {options.rig}; quartiles and median (25 / 50 / 75 %)\n")
    print("| method | cameras [s] | views | reached | T_SC0 [s] | views | reached | both [s] |\n" + "|---" * 8 + "|")
    for name, documents in found.items():
        chosen = [documents[p] for p in sorted(persons)]
        cameras = [needed(d, "cameras") for d in chosen]
        views = [needed(d, "cameras", "right_views") for d in chosen]
        imu = [needed(d, "camera_imu") for d in chosen]
        imu_views = [needed(d, "camera_imu", "right_views") for d in chosen]
        print(f"| {name} | {quartiles(cameras)} | {quartiles(views, 0)} | {sum(c < math.inf for c in cameras)} "
              f"| {quartiles(imu)} | {quartiles(imu_views, 0)} | {sum(c < math.inf for c in imu)} "
              f"| {quartiles([a + b for a, b in zip(cameras, imu)])} |")
    print("\n| guided over unguided (95 %) | cameras | bar | T_SC0 | bar |\n|---|---|---|---|---|")
    for guided in (n for n in found if n.startswith("guided")):
        for other in (n for n in ("free", "dance") if n in found):
            cells = []
            for stage, bar in BARS.items():
                a, b = ([needed(found[n][p], stage) for p in sorted(persons)] for n in (guided, other))
                low, high = interval(a, b)
                cells += [f"{text(ratio(a, b), 2)} ({text(low, 2)} to {text(high, 2)})", f"{bar}"]
            print(f"| {guided} / {other} | " + " | ".join(cells) + " |")
    stop_table(found, sorted(persons))
    imu_stop_table(found, sorted(persons))


def within(ratios):
    return f"{sum(abs(r - 1) <= STOP for r in ratios)} of {len(ratios)}"


def judged_stops(documents, stage):
    """What was found of the stops by pixels, and stop over best time of all persons."""
    judged = [(d.get("stop") or {}).get(stage) for d in documents]
    ratios = [j["stopped_s"] / j["best_s"] if j and j["best_s"] else math.inf for j in judged]
    return [j for j in judged if j], ratios


def print_draws(found, persons, stage):
    """Below a table: whether draws of the noise agree with the first order."""
    for name, documents in found.items():
        squares = [(j["drawn_px"] / j["expected_px"]) ** 2
                   for j in judged_stops([documents[p] for p in persons], stage)[0]]
        if squares:
            print(f"<!-- {name}: drawn^2 over expected^2, mean of {len(squares)}: {sum(squares) / len(squares):.3f} -->")


def predicted_over_expected(judged):
    return quartiles([j["predicted_px"] / j["expected_px"] for j in judged], 3)


def stop_table(found, persons):
    """The best stop by the error of the recording's own noise, and by the expected one."""
    print("\n| stop of | cameras stopped [s] | over the best, own noise | within 15 % | error there [px] | above 0.1 px "
          "| over the best, expected error | within 15 % | predicted over expected there | IMU stopped |"
          "\n|---|---|---|---|---|---|---|---|---|---|")
    for name in (n for n in found if n.startswith("guided")):
        chosen = [found[name][p] for p in persons]
        stops = [needed(d, "cameras", "stopped_s") for d in chosen]
        best = [needed(d, "cameras") for d in chosen]
        ratios = [s / b if b < math.inf and s < math.inf else math.inf for s, b in zip(stops, best)]
        errors = [(d["convergence"]["cameras"].get("at_end") or {}).get("projection_px") for d in chosen]
        errors = [math.inf if e is None else e for e in errors]
        imu = sum(needed(d, "camera_imu", "stopped_s") < math.inf for d in chosen)
        expected, predicted = ["–", "–"], "–"
        judged, by = judged_stops(chosen, "cameras")
        if judged:
            expected = [quartiles(by, 2), within(by)]
            predicted = predicted_over_expected(judged)
        print(f"| {name} | {quartiles(stops)} | {quartiles(ratios, 2)} | {within(ratios)} "
              f"| {quartiles(errors, 3)} | {sum(e > 0.1 for e in errors)} | {expected[0]} | {expected[1]} "
              f"| {predicted} | {imu} of {len(chosen)} |")
    print_draws(found, persons, "cameras")


def imu_stop_table(found, persons):
    """The camera-IMU stage's stop by the expected error of points that the IMU predicts."""
    print("\n| stop of | IMU stopped [s] | over the best, expected error | within 15 % | predicted over expected there "
          "| error there, own noise [px] |\n|---|---|---|---|---|---|")
    for name, documents in found.items():
        chosen = [documents[p] for p in persons]
        judged, ratios = judged_stops(chosen, "camera_imu")
        if not judged:
            continue
        stops = [needed(d, "camera_imu", "stopped_s") for d in chosen]
        errors = [(d["convergence"]["camera_imu"].get("at_end") or {}).get("reprojection_px") for d in chosen]
        errors = [math.inf if e is None else e for e in errors]
        print(f"| {name} | {quartiles(stops)} | {quartiles(ratios, 2)} | {within(ratios)} "
              f"| {predicted_over_expected(judged)} | {quartiles(errors, 3)} |")
    print_draws(found, persons, "camera_imu")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plumbline", default="build/evaluate/plumbline")
    parser.add_argument("--work", required=True)
    parser.add_argument("--persons", type=int, default=50)
    parser.add_argument("--rig", default="euroc")
    parser.add_argument("--first-seed", type=int, default=1, help="of the first person; the others' follow")
    parser.add_argument("--duration", type=float, default=120)
    parser.add_argument("--only", default="*", help="methods that are recorded and compared")
    parser.add_argument("--table", action="store_true", help="print only what is there")
    options = parser.parse_args()
    if not options.table:
        # In an order that has all skills early: a run that is cut short is of all of them.
        for person in sorted(range(1, options.persons + 1), key=lambda p: 0.618034 * p % 1):
            for name in METHODS:
                if fnmatch.fnmatch(name, options.only):
                    record(options, name, person)
    table(options)


if __name__ == "__main__":
    main()
