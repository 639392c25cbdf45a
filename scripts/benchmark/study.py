#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times of a study's nights: the first, an unchanged one, and one with a new participant, at several sizes.

Sessions of 30 s with corners given, two for each participant, four held-out recordings, three perturbations,
all pages. Prints a Markdown table; CPU seconds are those of all processes (user and system).
"""
import argparse
import os
import resource
import subprocess
import tempfile
import time


def recording(plumbline, path, seed, seconds):
    if not os.path.isdir(path):
        subprocess.run([plumbline, "simulate", "--out", path, "--seed", str(seed), "--duration", str(seconds)],
                       check=True, stdout=subprocess.DEVNULL)


def write_study(plumbline, root, participants, seconds):
    """A definition of so many participants; recordings that are there are kept."""
    lines = ["study: benchmark", "methods: [free, guided]", "sessions:"]
    for p in range(1, participants + 1):
        for m, method in enumerate(("free", "guided")):
            name = f"p{p:03d}_{method}"
            recording(plumbline, f"{root}/{name}", 100 + 2 * p + m, seconds)
            period = 1 + (p + m) % 2
            lines.append(f"  - {{name: {name}, participant: p{p:03d}, method: {method}, period: {period}, "
                         f"path: {name}, capture_s: {60 + 7 * p % 23 + 5 * m}}}")
    lines.append("held_out:")
    for e in range(1, 5):
        recording(plumbline, f"{root}/eval{e}", e, seconds)
        lines.append(f"  - {{name: eval{e}, path: eval{e}}}")
    lines += ["perturbations: {offsets_ms: [100, 10, 1]}", "endpoints: [held_out_rmse_px, capture_s]", ""]
    with open(f"{root}/STUDY.yaml", "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


def night(plumbline, root, out):
    """Wall and CPU seconds."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([plumbline, "study", f"{root}/STUDY.yaml", "--out", out], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.monotonic() - start, cpu


def folder_size(path):
    return sum(os.path.getsize(os.path.join(folder, name)) for folder, _, names in os.walk(path) for name in names)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plumbline", required=True)
    parser.add_argument("--sessions", default="26,50,100", help="sizes, e.g. 26,50,100")
    parser.add_argument("--seconds", type=float, default=30)
    arguments = parser.parse_args()
    print("| sessions | first night | CPU | unchanged | with a new participant | index.html | folder |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as work:
        for sessions in map(int, arguments.sessions.split(",")):
            root, out = f"{work}/data", f"{work}/night{sessions}"
            write_study(arguments.plumbline, root, sessions // 2, arguments.seconds)
            first, cpu = night(arguments.plumbline, root, out)
            unchanged, _ = night(arguments.plumbline, root, out)
            write_study(arguments.plumbline, root, sessions // 2 + 1, arguments.seconds)
            further, _ = night(arguments.plumbline, root, out)
            index = os.path.getsize(f"{out}/index.html") / 1e6
            print(f"| {sessions} | {first:.1f} s | {cpu:.1f} s | {unchanged:.2f} s | {further:.1f} s | "
                  f"{index:.2f} MB | {folder_size(out) / 1e6:.0f} MB |", flush=True)


if __name__ == "__main__":
    main()
