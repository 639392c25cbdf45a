#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many views are enough, by which choice? Runs view_choice_evidence on pools of a recording and
prints the tables of docs/counterfactuals.md.

  scripts/counterfactuals_evidence.py --program build/tests/benchmarks/view_choice_evidence \\
      --session DATA/euroc_imu_april --shape target_shape.yaml --out FOLDER [--only PATTERN] [--table] [--guide] [--band SHARE]

Outputs are kept in --out, one file per pool, and not made again. --shape is the board's own shape, best
from another recording (`plumbline calibrate OTHER --target-shape auto` writes it); pools named "bent"
know it, those named "flat" take the board as target.yaml has it. The file's tag_edge is another
recording's and detector's: set it to 0 where these differ. With --guide: only what a guide keeps of the candidates,
played to it as they were recorded; with --candidates 865 these are all of a pool of EuRoC's, so that one start is enough.
With --band 0.4: only corners in the middle 40 % of the images' height, as of a camera that is never used elsewhere.
"""

import argparse
import collections
import fnmatch
import itertools
import math
import pathlib
import subprocess
import sys

STRATEGIES = ["random", "recorded", "coverage", "mi", "predicted-error"]
LEVELS = (10, 5, 2)  # % above the whole pool's held-out error
STOP = 0.02
LEAST_VIEWS = 8


def quantile(values, p):
    values = sorted(values)
    at = p * (len(values) - 1)
    low = math.floor(at)
    high = min(low + 1, len(values) - 1)
    if values[high] == math.inf:
        return values[low] if at == low else math.inf
    return values[low] + (values[high] - values[low]) * (at - low)


def pools():
    """Names and arguments, the most telling first."""
    cameras = {"stereo": "both", "cam0": "cam0", "cam1": "cam1"}
    losses = {"none": "0", "cauchy": "3", "cauchy1.5": "1.5"}  # px; 3 is calibrate's own
    splits = ["1s", "first-second", "second-first", "3s", "interleaved"]
    for split, loss, camera, shape, model in itertools.product(
        splits, losses, cameras, ["flat", "bent"], ["radtan", "equidistant"]
    ):
        yield f"{camera}-{model}-{loss}-{shape}-{split}", [model, losses[loss], shape, cameras[camera], split]


def views(options):
    """The last part of a file's name."""
    return ("guide" if options.guide else str(options.views)) + (f"band{options.band:g}" if options.band < 1 else "")


def run(options):
    folder = pathlib.Path(options.out)
    folder.mkdir(parents=True, exist_ok=True)
    for name, (model, loss, shape, camera, split) in pools():
        path = folder / f"{name}-{options.candidates}-{options.starts}-{views(options)}.txt"
        if path.exists() or not fnmatch.fnmatch(name, options.only):
            continue
        shape = options.shape if shape == "bent" else "flat"
        numbers = [str(options.starts), str(options.candidates), str(options.views)]
        command = [options.program, options.session, model, loss, shape, camera, split, *numbers]
        command += ["guide"] if options.guide else []
        command += [f"band={options.band:g}"] if options.band < 1 else []
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 1):  # 1: this pool has no calibration
            sys.exit(f"{' '.join(command)}: ended with {done.returncode}\n{done.stderr}")
        part = path.with_suffix(".part")
        part.write_text(done.stdout)
        part.rename(path)


class Pool:
    """What one run printed."""

    def __init__(self, path):
        self.full = None
        self.curves = collections.defaultdict(dict)  # strategy -> start -> {views: px}
        self.steps = collections.defaultdict(list)  # start -> [(views, E, excess)]
        for line in path.read_text().splitlines():
            words = line.split()
            if words[0] == "pool":
                self.frames, self.held, self.full = int(words[1]), int(words[2]), float(words[3])
            elif words[0] == "curve":
                curve = dict(w.split("=") for w in words[3:])
                self.curves[words[2]][int(words[1])] = {int(n): float(px) for n, px in curve.items()}
            elif words[0] == "step":
                self.steps[int(words[1])].append((int(words[2]), float(words[6]), float(words[7])))

    def needed(self, curve, percent):
        """First number of views from which on the curve stays within so much of the whole pool's error."""
        found = math.inf
        for views, px in curve.items():
            if px > self.full * (1 + percent / 100):
                found = math.inf
            elif found == math.inf:
                found = views
        return found

    def all_needed(self, strategy, percent):
        return [self.needed(curve, percent) for curve in self.curves[strategy].values()]

    def median_needed(self, strategy):
        return [quantile(self.all_needed(strategy, p), 0.5) for p in LEVELS]

    def excess_at(self, strategy, views):
        values = [c[views] for c in self.curves[strategy].values() if views in c]
        return 100 * (quantile(values, 0.5) / self.full - 1) if values else math.nan

    def stops(self):
        """Per start: views at the stop, predicted and measured excess [%]."""
        found = []
        for start, steps in self.steps.items():
            curve = self.curves["predicted-error"][start]
            stop = next(((n, x) for n, _, x in steps if n >= LEAST_VIEWS and x <= STOP), None)
            n, predicted = stop if stop else (max(curve), steps[-1][2])
            at = min(v for v in curve if v >= n)
            found.append((n, 100 * predicted, 100 * (curve[at] / self.full - 1)))
        return found


def text(views):
    return "–" if views == math.inf else f"{views:g}"


def pools_read(options):
    read = []
    pattern = f"*-{options.candidates}-{options.starts}-{views(options)}.txt"
    for path in sorted(pathlib.Path(options.out).glob(pattern)):
        name = path.stem.rsplit("-", 3)[0]
        pool = Pool(path)
        if fnmatch.fnmatch(name, options.only) and pool.full is not None and pool.curves:
            read.append((name, pool))
    order = {name: i for i, (name, _) in enumerate(pools())}
    return sorted(read, key=lambda item: order.get(item[0], 0))


def kept_by(pool, guide):
    """Over the starts: the views that a guide keeps, what is above the whole pool's error then [%], and from how many
    views on it is within 5 %; medians."""
    curves = [c for c in pool.curves[guide].values() if c]
    kept = quantile([max(c) for c in curves], 0.5)
    excess = quantile([100 * (c[max(c)] / pool.full - 1) for c in curves], 0.5)
    return f"{kept:g}", f"{excess:.1f}", text(quantile([pool.needed(c, 5) for c in curves], 0.5))


def guide_table(options):
    print("| pool | held out [px] | mi: kept | above [%] | within 5 % from | predicted-error: kept | above [%] | within 5 % from |")
    print("|---" * 8 + "|")
    for name, pool in pools_read(options):
        cells = [c for guide in ("guide-mi", "guide-predicted-error") for c in kept_by(pool, guide)]
        print(f"| {name} | {pool.full:.4f} | " + " | ".join(cells) + " |")


def joint_table(read):
    """Medians over the starts of all splits together."""
    together = collections.defaultdict(list)
    for name, pool in read:
        camera, model, loss, shape, _ = name.split("-", 4)
        together[f"{camera}, {model}, {loss}, {shape}"].append(pool)
    print("\n| all splits | starts | " + " | ".join(STRATEGIES) + " |")
    print("|---" * (2 + len(STRATEGIES)) + "|")
    for name, pools_of in together.items():
        cells = []
        for s in STRATEGIES:
            needed = ([n for pool in pools_of for n in pool.all_needed(s, p)] for p in LEVELS)
            cells.append("/".join(text(quantile(n, 0.5)) for n in needed))
        starts = sum(len(pool.curves["random"]) for pool in pools_of)
        print(f"| {name} | {starts} | " + " | ".join(cells) + " |")


def table(options):
    read = [(name, pool) for name, pool in pools_read(options) if pool.steps]
    print("| pool | held out [px] | " + " | ".join(STRATEGIES) + " |")
    print("|---" * (2 + len(STRATEGIES)) + "|")
    for name, pool in read:
        cells = ["/".join(text(v) for v in pool.median_needed(s)) for s in STRATEGIES]
        print(f"| {name} | {pool.full:.4f} | " + " | ".join(cells) + " |")
    joint_table(read)
    print("\n| pool | excess at 4 views | at 5 | at 6 | at 8 |\n|---|---|---|---|---|")
    for name, pool in read:
        cells = [
            "/".join(f"{pool.excess_at(s, n):.1f}" for s in ("random", "mi", "predicted-error")) for n in (4, 5, 6, 8)
        ]
        print(f"| {name} | " + " | ".join(cells) + " |")
    print("\n| pool | stops with views | predicted excess [%] | measured [%] | worst [%] |\n|---|---|---|---|---|")
    for name, pool in read:
        stops = pool.stops()
        n, predicted, measured = ([s[i] for s in stops] for i in range(3))
        print(
            f"| {name} | {quantile(n, 0.5):g} ({min(n)} to {max(n)}) | {quantile(predicted, 0.5):.1f} "
            f"| {quantile(measured, 0.5):.1f} | {max(measured):.1f} |"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program")
    parser.add_argument("--session")
    parser.add_argument("--shape")
    parser.add_argument("--out", required=True)
    parser.add_argument("--only", default="*", help="pattern of pools")
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--candidates", type=int, default=200)
    parser.add_argument("--views", type=int, default=40)
    parser.add_argument("--guide", action="store_true", help="what a guide keeps")
    parser.add_argument("--band", type=float, default=1, help="share of the images' height whose corners are used")
    parser.add_argument("--table", action="store_true", help="only the tables, of what has been run")
    options = parser.parse_args()
    if not options.table:
        run(options)
    guide_table(options) if options.guide else table(options)


if __name__ == "__main__":
    main()
