#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the sources named on standard input as compile_commands.json of a build folder says, each
by itself and for its warnings only: compile_alone.py BUILD < LIST. Exits with 1 if one fails."""
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys


def command_of(entry):
    """The entry's command without the launcher in front, and without anything written."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        words = words[1:]
    for option in ("-MT", "-MF"):
        if option in words:
            at = words.index(option)
            del words[at:at + 2]
    words[words.index("-o") + 1] = os.devnull
    return [word for word in words if word != "-MD"]


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: compile_alone.py BUILD < LIST")
    wanted = {os.path.abspath(line.strip()) for line in sys.stdin if line.strip()}
    with open(os.path.join(sys.argv[1], "compile_commands.json"), encoding="utf-8") as file:
        entries = {os.path.abspath(entry["file"]): entry for entry in json.load(file)}
    absent = sorted(wanted - entries.keys())
    if absent:
        sys.exit(f"compile_alone.py: {sys.argv[1]} does not compile {', '.join(absent)}")

    def compiled(path):
        run = subprocess.run(command_of(entries[path]), cwd=entries[path]["directory"],
                             capture_output=True, text=True, check=False)
        sys.stderr.write(run.stderr)
        return run.returncode == 0

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        if not all(list(pool.map(compiled, sorted(wanted)))):
            sys.exit(1)


if __name__ == "__main__":
    main()
