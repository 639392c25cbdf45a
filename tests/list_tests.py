#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one CTest entry per source file of a GoogleTest program, named after the file: a failure tells
where to look, and files run in parallel although they share a program.

list_tests.py PROGRAM OUTPUT.cmake [PROPERTY VALUE]... [ENTRY=COST]...     the properties go to every entry
"""
import collections
import json
import os
import subprocess
import sys
import tempfile


def tests_by_file(program):
    """The full names of the program's tests under the path of their file below tests/."""
    with tempfile.NamedTemporaryFile(suffix=".json") as listing:
        environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0")
        subprocess.run([program, "--gtest_list_tests", f"--gtest_output=json:{listing.name}"],
                       check=True, stdout=subprocess.DEVNULL, env=environment)
        suites = json.load(listing)["testsuites"]
    files = collections.defaultdict(list)
    for suite in suites:
        for test in suite["testsuite"]:
            files[test["file"].rsplit("tests/", 1)[1]].append((suite["name"], test["name"]))
    return files


def filters(files):
    """For each file the shortest filter: whole suites where no other file adds to them."""
    homes = collections.defaultdict(set)
    seen = set()
    for path, tests in files.items():
        for suite, test in tests:
            if (suite, test) in seen:
                sys.exit(f"list_tests.py: {path}: {suite}.{test} is the name of another test, too")
            seen.add((suite, test))
            homes[suite].add(path)
    return {path: list(dict.fromkeys(f"{suite}.*" if len(homes[suite]) == 1 else f"{suite}.{test}"
                                     for suite, test in tests))
            for path, tests in files.items()}


def entries(program, files, words):
    """CMake's lines for the files' filters, after the words of the command line."""
    costs = dict(word.split("=") for word in words if "=" in word)
    values = " ".join(f"[==[{word}]==]" for word in words if "=" not in word)
    lines = []
    for path, names in sorted(files.items()):
        name = path.removesuffix(".cpp")
        lines.append(f"add_test([==[{name}]==] [==[{program}]==] [==[--gtest_filter={':'.join(names)}]==])")
        cost = f" COST {costs[name]}" if name in costs else ""
        lines.append(f"set_tests_properties([==[{name}]==] PROPERTIES {values}{cost})")
    return lines


def main():
    program, output, *words = sys.argv[1:]
    lines = entries(program, filters(tests_by_file(program)), words)
    with open(output, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
