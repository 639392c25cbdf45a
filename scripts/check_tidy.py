#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""clang-tidy and g++ over the sources of the libraries and the command line, warnings are errors.

check_tidy.py BUILD [--all] [--minutes M]     BUILD is configured for g++, with the target plumbline_commit built

The scripts build with clang++ and precompiled headers; here each source stands alone, so that a missing
include shows. What changed since the merge base with origin/main is checked, the newest change first.
On main itself (a fresh clone, as of CI) there is nothing to compare with: all files are due, and those
changed last come first. --minutes starts no further file after that time and says what is left.
"""
import argparse
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys
import time

ROOMS = ["calibrator", "datasets", "report", "evaluate"]


def git(*words):
    run = subprocess.run(["git", *words], check=False, text=True, capture_output=True)
    return run.stdout.split("\n")[:-1] if run.returncode == 0 else []


def newest_first(everything):
    """The files to look at, a header standing for itself: uncommitted ones, then by their last commit."""
    base = git("merge-base", "HEAD", "origin/main")
    bounded = not everything and base and base != git("rev-parse", "HEAD")
    commits = f"{base[0]}..HEAD" if bounded else "HEAD"
    paths = (git("diff", "--name-only", "HEAD", "--", *ROOMS)
             + git("log", "--format=", "--name-only", commits, "--", *ROOMS))
    present = set(git("ls-files", "--", *ROOMS))
    return [path for path in dict.fromkeys(paths) if path in present]


def source_of(path):
    """The source that shows a header's faults: the one beside it, or one that includes it."""
    if not path.endswith(".h"):
        return path if path.endswith(".cpp") else None
    beside = path[:-2] + ".cpp"
    users = git("grep", "-l", "-F", f'"{path}"', "--", *ROOMS)
    return beside if os.path.exists(beside) else next((u for u in users if u.endswith(".cpp")), None)


def compile_command(entry):
    """g++'s command of compile_commands.json, without launcher and without anything written."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        words = words[1:]
    words[words.index("-o") + 1] = os.devnull
    return words


def faults_of(path, build, entry):
    """What clang-tidy and g++ say of a source; empty if nothing."""
    tidy = ["clang-tidy", "-p", build, "--quiet", "--extra-arg=-Wno-unknown-warning-option", path]
    said = ""
    for command, folder in ((tidy, "."), (compile_command(entry), entry["directory"])):
        run = subprocess.run(command, cwd=folder, check=False, text=True, capture_output=True)
        if run.returncode != 0:
            said += run.stdout + run.stderr
    return said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--all", action="store_true", help="every file, also on a branch")
    parser.add_argument("--minutes", type=float, default=float("inf"))
    options = parser.parse_args()
    with open(os.path.join(options.build, "compile_commands.json"), encoding="utf-8") as file:
        entries = {os.path.relpath(entry["file"]): entry for entry in json.load(file)}
    sources = [s for s in dict.fromkeys(map(source_of, newest_first(options.all))) if s in entries]
    end = time.monotonic() + 60 * options.minutes

    def checked(path):
        if time.monotonic() > end:
            return None
        said = faults_of(path, options.build, entries[path])
        print(said, end="", file=sys.stderr, flush=True)
        return not said

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(checked, sources))
    left = results.count(None)
    print(f"check_tidy: {len(sources) - left} of {len(sources)} sources, the last changed first"
          + (f"; {left} left out after {options.minutes:g} minutes" if left else ""))
    sys.exit(1 if False in results else 0)


if __name__ == "__main__":
    main()
