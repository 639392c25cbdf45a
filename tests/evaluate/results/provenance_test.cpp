// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/provenance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(ShellWords, PlainArgumentsStayAsTheyAre) {
  EXPECT_EQ(shellWords({"plumbline", "calibrate", "a/b.c", "--models=pinhole-radtan", "1,2"}),
            "plumbline calibrate a/b.c --models=pinhole-radtan 1,2");
}

TEST(ShellWords, AShellReadsBackWhatItMustNotTouch) {
  EXPECT_EQ(shellWords({"my session", "{run}", "", "it's", "$HOME"}),
            R"('my session' '{run}' '' 'it'\''s' '$HOME')");
}

TEST(Provenance, NamesTheCommandWithoutACommandLine) {
  const Provenance provenance = makeProvenance("calibrate", {{"--loss", "none"}});
  EXPECT_EQ(provenance.command, "calibrate");
  EXPECT_EQ(provenance.version, programVersion());
}

// A study's steps write into hidden folders, which are gone when anybody reads of them.
TEST(Provenance, NamesTheFolderThatAResultHasInTheEnd) {
  keepCommandLine({"/bin/plumbline", "calibrate", "p1", "--out",
                   "/n/.calibrate.partial-a1b2c3/result", "--threads", "1"});
  const std::string command = makeProvenance("calibrate", {}).command;
  keepCommandLine({});
  EXPECT_EQ(command, "plumbline calibrate p1 --out /n/calibrate --threads 1");
}

}  // namespace
}  // namespace plumbline
