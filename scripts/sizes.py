#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints a table of the sizes of the C++ sources, a column per commit.

Lines are those of the files as they stand, blank ones and the licence's among them. Comments are the share of
lines with one, alone or behind code, of those that are not blank. A folder counts where it holds sources itself.
"""
import argparse
import collections
import io
import statistics
import subprocess
import tarfile


def texts_of(commit):
    """The lines of every C++ file of a commit by path."""
    archive = subprocess.run(["git", "archive", commit], check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        return {member.name: tar.extractfile(member).read().decode().splitlines()
                for member in tar if member.isfile() and member.name.endswith((".cpp", ".h"))}


def has_comment(line):
    """Whether a stripped line has a comment of its own: not the end of a namespace, nor a // within a string."""
    before, comment, after = line.partition("//")
    return bool(comment) and before.count('"') % 2 == 0 and not after.strip().startswith("namespace")


def comment_share(files):
    lines = [line.strip() for text in files for line in text if line.strip() and "SPDX-License" not in line]
    return sum(has_comment(line) for line in lines) / max(1, len(lines))


def percentile(values, part):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))]


def sizes(commit):
    texts = texts_of(commit)
    code = {path: text for path, text in texts.items() if not path.startswith("tests/")}
    lengths = [len(text) for text in code.values()]
    tested = sum(len(text) for path, text in texts.items() if path.startswith("tests/"))
    folders = collections.Counter(path.rsplit("/", 1)[0] for path in code)
    largest, most = folders.most_common(1)[0]
    return {
        "C++ files outside tests": str(len(code)),
        "their lines": f"{sum(lengths):,}",
        "lines of a file, median": f"{statistics.median(lengths):.0f}",
        "lines of a file, 95th percentile": str(percentile(lengths, 0.95)),
        "longest file": str(max(lengths)),
        "files of fewer than 60 lines": f"{sum(n < 60 for n in lengths) / len(lengths):.0%}",
        "folders with sources": str(len(folders)),
        "largest folder": f"{most} (`{largest}`)",
        "lines of tests per line outside": f"{tested / sum(lengths):.2f}",
        "comments in sources": f"{comment_share([t for p, t in code.items() if p.endswith('.cpp')]):.1%}",
        "comments in headers": f"{comment_share([t for p, t in code.items() if p.endswith('.h')]):.1%}",
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commits", nargs="*", default=["HEAD"], metavar="COMMIT")
    commits = parser.parse_args().commits
    columns = [sizes(commit) for commit in commits]
    print("| | " + " | ".join(commits) + " |")
    print("|---" * (len(commits) + 1) + "|")
    for row in columns[0]:
        print(f"| {row} | " + " | ".join(column[row] for column in columns) + " |")


if __name__ == "__main__":
    main()
