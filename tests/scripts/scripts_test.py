#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The checks of CI find the faults that they are there for."""
import os
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(ROOT, "scripts"), os.path.join(ROOT, "tests")]
sys.dont_write_bytecode = True

import check_layers  # noqa: E402
import check_tidy  # noqa: E402
import list_tests  # noqa: E402
import sizes  # noqa: E402

TABLE = """
| room | what it does | includes | heavy libraries |
|---|---|---|---|
| `low/base` | values | | |
| `low/solver` | `low/top` is no name here | `base` | Ceres |
| `high/jobs` | all of it | `low` | |
"""


class Layers(unittest.TestCase):
    def faults(self, path, *includes):
        text = "".join(f"#include {include}\n" for include in includes)
        return check_layers.faults_of(check_layers.Rooms(TABLE), path, text)

    def test_includes_downward_pass(self):
        self.assertEqual(self.faults("low/solver/a.cpp", '"low/base/v.h"', '"low/solver/a.h"', "<vector>",
                                     "<ceres/ceres.h>"), [])
        self.assertEqual(self.faults("high/jobs/sub/a.cpp", '"low/solver/a.h"', '"generated/x.h"'), [])

    def test_an_include_upward_is_named_with_its_line(self):
        self.assertEqual(self.faults("low/base/v.h", "<vector>", '"low/solver/a.h"'),
                         ["low/base/v.h:2: low/base may not include low/solver"])

    def test_a_heavy_library_out_of_its_room(self):
        self.assertEqual(self.faults("high/jobs/a.cpp", "<ceres/ceres.h>"),
                         ["high/jobs/a.cpp:1: high/jobs may not use Ceres"])

    def test_a_file_in_no_room_and_an_include_from_none(self):
        self.assertEqual(len(self.faults("low/a.cpp")), 1)
        self.assertEqual(len(self.faults("low/base/a.cpp", '"v.h"')), 1)

    def test_a_crowded_folder_is_named(self):
        files = [f"low/base/{i}.h" for i in range(check_layers.MOST_SOURCES)]
        self.assertEqual(check_layers.crowded(files + ["low/base/sub/a.h"]), [])
        self.assertIn("low/base: 26 sources", check_layers.crowded(files + ["low/base/more.h"])[0])

    def test_a_circle_and_an_unknown_name_in_the_table(self):
        self.assertEqual(check_layers.Rooms(TABLE).faults_of_table(), [])
        circle = check_layers.Rooms(TABLE.replace("values | |", "values | `solver` |"))
        self.assertIn("circle: high/jobs, low/base, low/solver", circle.faults_of_table()[0])
        unknown = check_layers.Rooms(TABLE.replace("`low` |", "`attic` |"))
        self.assertIn("high/jobs names high/attic", unknown.faults_of_table()[0])


class Tidy(unittest.TestCase):
    """In a repository of its own, with origin/main behind, at or absent from HEAD."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        self.git("init", "-q")
        for number, name in enumerate(["calibrator/old.cpp", "calibrator/a.h", "report/new.cpp"]):
            self.write(name)
            self.git("add", ".")
            self.git("-c", "user.name=n", "-c", "user.email=e", "commit", "-qm", str(number))

    def git(self, *words):
        subprocess.run(["git", *words], check=True, stdout=subprocess.DEVNULL)

    def write(self, name, text="x\n"):
        os.makedirs(os.path.dirname(name), exist_ok=True)
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)

    def test_a_branch_is_checked_from_its_merge_base(self):
        self.git("update-ref", "refs/remotes/origin/main", "HEAD~1")
        self.assertEqual(check_tidy.newest_first(False), ["report/new.cpp"])
        self.assertEqual(len(check_tidy.newest_first(True)), 3)

    def test_main_is_checked_whole_the_newest_first(self):
        self.git("update-ref", "refs/remotes/origin/main", "HEAD")
        self.write("calibrator/old.cpp", "changed\n")
        self.assertEqual(check_tidy.newest_first(False),
                         ["calibrator/old.cpp", "report/new.cpp", "calibrator/a.h"])

    def test_a_header_is_checked_by_a_source_that_shows_it(self):
        self.assertIsNone(check_tidy.source_of("calibrator/a.h"))
        self.write("report/new.cpp", '#include "calibrator/a.h"\n')
        self.assertEqual(check_tidy.source_of("calibrator/a.h"), "report/new.cpp")
        self.write("calibrator/a.cpp")
        self.assertEqual(check_tidy.source_of("calibrator/a.h"), "calibrator/a.cpp")


class ListTests(unittest.TestCase):
    def test_a_suite_of_two_files_is_told_apart_by_its_tests(self):
        self.assertEqual(list_tests.filters({"a": [("S", "one"), ("S", "two"), ("T", "x")], "b": [("S", "y")]}),
                         {"a": ["S.one", "S.two", "T.*"], "b": ["S.y"]})

    def test_an_entry_may_have_a_cost_of_its_own(self):
        lines = list_tests.entries("p", {"a/x.cpp": ["S.*"], "y.cpp": ["T.*"]}, ["COST", "1", "a/x=20", "b/z=30"])
        self.assertEqual(lines[1], "set_tests_properties([==[a/x]==] PROPERTIES [==[COST]==] [==[1]==] COST 20)")
        self.assertEqual(lines[3], "set_tests_properties([==[y]==] PROPERTIES [==[COST]==] [==[1]==])")

    def test_two_tests_of_one_name_are_refused(self):
        with self.assertRaises(SystemExit), mock.patch("builtins.print"):
            list_tests.filters({"a": [("S", "one")], "b": [("S", "one")]})


class Sizes(unittest.TestCase):
    def test_comments_are_counted_without_licence_and_blank_lines(self):
        text = ["// SPDX-License-Identifier: X", "", "// why", "int a;", "  /// what", "int b;"]
        self.assertEqual(sizes.comment_share([text]), 0.5)
        self.assertEqual(sizes.percentile([3, 1, 2], 0.95), 3)


if __name__ == "__main__":
    unittest.main()
