#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails where an include breaks the table of rooms in docs/architecture.md, where a heavy library leaks out
of its room, or where a folder holds more sources than a reader takes in.

That table is the one list of rooms. Its third column names what a room may include besides itself: rooms of
the same top-level folder by their last name, others in full, or whole top-level folders; the fourth names
the libraries that are its own.
"""
import collections
import re
import subprocess
import sys

TABLE = "docs/architecture.md"
MOST_SOURCES = 25  # of a folder
HEAVY = {
    "Ceres": r"ceres/",
    "VTK": r"vtk\w+\.h",
    "rosbag": r"rosbag/|ros/|console_bridge/",
    "SQLite": r"SQLiteCpp/|sqlite3\.h",
    "OpenCV": r"opencv2/",
    "apriltag": r"apriltag/",
    "yaml-cpp": r"yaml-cpp/",
    "libpng": r"png\.h",
    "libjpeg": r"jpeglib\.h|jerror\.h",
    "CLI11": r"CLI/",
    "cairo": r"cairo",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


class Rooms:
    """The table: for every room, which it may include and which heavy libraries are its own."""

    def __init__(self, text):
        self.includes = {}
        self.libraries = {}
        rows = []
        for line in text.splitlines():
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if len(cells) == 4 and re.fullmatch(r"`\w+(/\w+)+`", cells[0]):
                rows.append((cells[0].strip("`"), re.findall(r"`([\w/]+)`", cells[2]), cells[3]))
        tops = {room.split("/")[0] for room, _, _ in rows}
        for room, names, libraries in rows:
            top = room.split("/")[0]
            self.includes[room] = [name if "/" in name or name in tops else f"{top}/{name}"
                                   for name in names]
            self.libraries[room] = [name for name in HEAVY if name in libraries]

    def of(self, path):
        """The room of a file; rooms in rooms are told apart by the longer name."""
        matches = [room for room in self.includes if path.startswith(room + "/")]
        return max(matches, key=len) if matches else None

    def may_include(self, home, there):
        return home == there or any((there + "/").startswith(name + "/") for name in self.includes[home])

    def faults_of_table(self):
        """Rooms that include each other, however far around, and names of no room."""
        faults = []
        below = {room: {other for other in self.includes if other != room and self.may_include(room, other)}
                 for room in self.includes}
        for room, names in self.includes.items():
            faults += [f"{TABLE}: {room} names {name}, which is no room" for name in names
                       if not any((other + "/").startswith(name + "/") for other in self.includes)]
        while below:
            floor = [room for room, others in below.items() if not others & below.keys()]
            if not floor:
                return faults + [f"{TABLE}: in a circle: {', '.join(sorted(below))}"]
            for room in floor:
                del below[room]
        return faults


def faults_of(rooms, path, text):
    """What is wrong with the includes of a file."""
    home = rooms.of(path)
    if home is None:
        return [f"{path}: in no room of {TABLE}"]
    faults = []
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        kind, target = match.groups()
        for name, pattern in HEAVY.items():
            if re.match(pattern, target) and name not in rooms.libraries[home]:
                faults.append(f"{path}:{number}: {home} may not use {name}")
        there = rooms.of(target)
        if kind == '"' and there is None and not target.startswith("generated/"):
            faults.append(f'{path}:{number}: "{target}" does not start at the root of the repository')
        elif kind == '"' and there and not rooms.may_include(home, there):
            faults.append(f"{path}:{number}: {home} may not include {there}")
    return faults


def crowded(files):
    """Folders with too many sources."""
    counts = collections.Counter(path.rsplit("/", 1)[0] for path in files)
    return [f"{folder}: {count} sources; at most {MOST_SOURCES}: part it" for folder, count in sorted(counts.items())
            if count > MOST_SOURCES]


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main():
    rooms = Rooms(read(TABLE))
    files = subprocess.run(["git", "ls-files", "--", "*.h", "*.cpp"], check=True, text=True,
                           capture_output=True).stdout.split()
    files = [path for path in files if not path.startswith("tests/")]
    faults = rooms.faults_of_table() + crowded(files)
    for path in files:
        faults += faults_of(rooms, path, read(path))
    print("\n".join(faults) if faults else f"layers: {len(files)} files in {len(rooms.includes)} rooms")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
