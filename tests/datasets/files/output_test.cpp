// SPDX-License-Identifier: BSD-3-Clause
// What an output may replace, what it leaves alone, and what it leaves behind.
#include "datasets/files/output.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/manifest.h"
#include "datasets/files/workplace.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Output : public testing::Test {
 protected:
  OutputRequest request(const std::string& name, bool replace = false) const {
    return {folder_.path(name), "export", "1.2", replace, {}, {}};
  }
  void make(const OutputRequest& request, const std::string& text = "text") const {
    OutputFolder out(request);
    out.write("a/b.txt", text);
    out.commit();
  }
  // The fault with which the request is refused; all files are as they were.
  std::optional<InputFault> refusal(const OutputRequest& request) const {
    const auto before = files();
    const auto fault = faultOf([&] { const OutputFolder out(request); });
    EXPECT_EQ(files(), before);
    return fault;
  }
  // Names and contents below the test's folder.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      const std::string name = fs::relative(entry.path(), folder_.path()).string();
      all[name] = entry.is_regular_file() ? std::string(MappedFile(entry.path()).text()) : "";
    }
    return all;
  }
  std::string text(const std::string& name) const {
    return std::string(MappedFile(folder_.path(name)).text());
  }

  TemporaryFolder folder_;
};

TEST_F(Output, AppearsWholeWithAManifestAndNothingBesideIt) {
  {
    OutputFolder out(request("new/er/out"));
    out.write("a/b.txt", "text");
    EXPECT_FALSE(fs::exists(folder_.path("new/er/out")));
    out.commit();
  }
  const auto manifest = readManifest(folder_.path("new/er/out"));
  ASSERT_TRUE(manifest);
  EXPECT_EQ(manifest->kind, "export");
  EXPECT_EQ(manifest->version, "1.2");
  ASSERT_EQ(manifest->files.size(), 1U);
  EXPECT_EQ(manifest->files.at("a/b.txt").bytes, 4U);
  EXPECT_EQ(manifest->files.at("a/b.txt").hash, "xxh64:" + contentHash("text"));
  EXPECT_FALSE(firstForeign(folder_.path("new/er/out"), *manifest));
  EXPECT_EQ(files().size(), 6U);  // new, er, out, a, b.txt, plumbline.json
}

TEST(NamedPath, EndsInTheLastName) {
  for (const char* path : {"a/out", "a/out/", "a/out//", "a/out/.", "a/out/b/.."}) {
    EXPECT_EQ(namedPath(path), fs::current_path() / "a/out") << path;
  }
  EXPECT_EQ(namedPath("."), fs::current_path());
}

TEST_F(Output, LeavesNothingUnlessCommitted) {
  { OutputFolder(request("new/er/out")).write("file", "text"); }
  EXPECT_TRUE(files().empty());
}

TEST_F(Output, KeepsTheModeThatTheUserAsksFor) {
  const mode_t before = ::umask(0027);
  make(request("out"));
  ::umask(before);
  EXPECT_EQ(fs::status(folder_.path("out")).permissions(), fs::perms(0750));
  EXPECT_EQ(fs::status(folder_.path("out/a/b.txt")).permissions(), fs::perms(0640));
}

TEST_F(Output, AnEarlierResultIsReplacedOnlyIfThatIsAllowed) {
  make(request("out"), "first");
  EXPECT_EQ(refusal(request("out")), InputFault::kResultExists);
  make(request("out", true), "second");
  EXPECT_EQ(text("out/a/b.txt"), "second");
  EXPECT_EQ(files().size(), 4U);
}

TEST_F(Output, LinksAreListedAndRemovedAsLinks) {
  folder_.write("elsewhere/file", "mine");
  folder_.write("result/file", "text");
  const fs::path result = folder_.path("result");
  fs::create_symlink("../elsewhere/file", result / "to_file");
  fs::create_directory_symlink("../elsewhere", result / "to_folder");
  fs::create_symlink("nowhere", result / "to_nothing");
  const Manifest manifest = manifestOf(result, "1.2", "step");
  ASSERT_EQ(manifest.files.size(), 4U);
  EXPECT_EQ(manifest.files.at("to_nothing").hash, "link:" + contentHash("nowhere"));
  EXPECT_FALSE(firstForeign(result, manifest));
  // A link of another path, or the file that it leads to in its place, is a change.
  fs::remove(result / "to_file");
  fs::create_symlink("../elsewhere/fil", result / "to_file");
  EXPECT_TRUE(firstForeign(result, manifest).value().changed);
  fs::remove(result / "to_file");
  folder_.write("result/to_file", "mine");
  EXPECT_TRUE(firstForeign(result, manifest).value().changed);
  removeListed(result, manifest);
  EXPECT_FALSE(fs::exists(result));
  EXPECT_EQ(text("elsewhere/file"), "mine");
}

TEST_F(Output, WhatAManifestDoesNotListMovesToPlacesThatAreFree) {
  make(request("out"));
  const auto manifest = readManifest(folder_.path("out"));
  ASSERT_TRUE(manifest);
  folder_.write("new/a/taken.txt", "new");
  folder_.write("new/b", "a file");
  for (const char* name : {"notes.txt", "a/taken.txt", "a/deep/notes.txt", "b/notes.txt"}) {
    folder_.write(std::string("out/") + name, "mine");
  }
  fs::create_symlink("nowhere", folder_.path("out/a/link"));
  moveUnlisted(folder_.path("out"), *manifest, folder_.path("new"));
  EXPECT_EQ(text("new/notes.txt"), "mine");
  EXPECT_EQ(text("new/a/deep/notes.txt"), "mine");
  EXPECT_TRUE(fs::is_symlink(folder_.path("new/a/link")));
  EXPECT_EQ(text("new/a/taken.txt"), "new");
  EXPECT_EQ(text("out/b/notes.txt"), "mine");
  EXPECT_EQ(text("out/a/b.txt"), "text");
  EXPECT_FALSE(fs::exists(folder_.path("new/a/b.txt")));
}

// Manifests of earlier versions list no links: a result's own would stay at each redo.
TEST_F(Output, AnUnlistedLinkThatTheNewResultHasAsWellGoes) {
  make(request("out"));
  const auto manifest = readManifest(folder_.path("out"));
  ASSERT_TRUE(manifest);
  for (const char* folder : {"out/a/", "new/a/"}) {
    fs::create_directories(folder_.path(folder));
    fs::create_symlink("nowhere", folder_.path(std::string(folder) + "same"));
    fs::create_symlink(folder, folder_.path(std::string(folder) + "other"));
  }
  moveUnlisted(folder_.path("out"), *manifest, folder_.path("new"));
  EXPECT_FALSE(fs::is_symlink(folder_.path("out/a/same")));
  EXPECT_EQ(fs::read_symlink(folder_.path("new/a/same")), "nowhere");
  EXPECT_EQ(fs::read_symlink(folder_.path("out/a/other")), "out/a/");
  EXPECT_EQ(fs::read_symlink(folder_.path("new/a/other")), "new/a/");
}

// In the workplace of a process that died between exchanging two results and removing the older.
TEST_F(Output, WhatIsSomebodyElsesStaysHoweverOftenTheRestIsRemoved) {
  make(request("out"));
  folder_.write("out/a/notes.txt", "mine");
  folder_.write(".out.partial-dEAd01/lock", "plumbline\nfor out\n");
  fs::rename(folder_.path("out"), folder_.path(".out.partial-dEAd01/result"));
  for (int night = 0; night < 3; ++night) removeDeadWorkplaces(folder_.path("out"));
  EXPECT_EQ(text(".out.partial-dEAd01/result/a/notes.txt"), "mine");
  EXPECT_FALSE(fs::exists(folder_.path(".out.partial-dEAd01/result/a/b.txt")));
  fs::remove(folder_.path(".out.partial-dEAd01/result/a/notes.txt"));
  removeDeadWorkplaces(folder_.path("out"));
  EXPECT_TRUE(files().empty());
}

TEST_F(Output, WhatIsSomebodyElsesMovesToTheResultThatTookThePlace) {
  make(request("out"));
  folder_.write("out/a/notes.txt", "mine");
  folder_.write(".out.partial-dEAd01/lock", "plumbline\nfor out\n");
  fs::rename(folder_.path("out"), folder_.path(".out.partial-dEAd01/result"));
  make(request("out"), "newer");
  removeDeadWorkplaces(folder_.path("out"));
  EXPECT_EQ(text("out/a/notes.txt"), "mine");
  EXPECT_EQ(text("out/a/b.txt"), "newer");
  EXPECT_FALSE(fs::exists(folder_.path(".out.partial-dEAd01")));
}

TEST_F(Output, AnEmptyFolderIsTaken) {
  fs::create_directories(folder_.path("out"));
  make(request("out"));
  EXPECT_EQ(text("out/a/b.txt"), "text");
}

TEST_F(Output, NothingThatIsNotOursIsEverRemoved) {
  folder_.write("foreign/notes.txt", "mine");
  EXPECT_EQ(refusal(request("foreign", true)), InputFault::kForeignFiles);
  make(request("out"));
  for (const char* name : {"out/notes.txt", "out/a/notes.txt", "out/z/deep/notes.txt"}) {
    folder_.write(name, "mine");
    EXPECT_EQ(refusal(request("out", true)), InputFault::kForeignFiles) << name;
    fs::remove(folder_.path(name));
    if (std::string(name).find("deep") != std::string::npos) fs::remove_all(folder_.path("out/z"));
  }
  fs::create_directories(folder_.path("out/empty"));
  EXPECT_EQ(refusal(request("out", true)), InputFault::kForeignFiles);
  fs::remove(folder_.path("out/empty"));
  fs::create_symlink(folder_.path("foreign/notes.txt"), folder_.path("out/link"));
  EXPECT_EQ(refusal(request("out", true)), InputFault::kForeignFiles);
  fs::remove(folder_.path("out/link"));
  folder_.write("out/a/b.txt", "edited");
  EXPECT_EQ(refusal(request("out", true)), InputFault::kForeignFiles);
  folder_.write("out/a/b.txt", "text");
  EXPECT_EQ(refusal(request("out", true)), std::nullopt);
}

TEST_F(Output, AManifestThatListsForeignFilesOrPathsOutsideRemovesNothing) {
  folder_.write("notes.txt", "mine");
  folder_.write("out/plumbline.json",
                R"({"schema": 1, "program": "plumbline", "version": "1", "kind": "export",
                    "files": {"../notes.txt": {"bytes": 4, "hash": "xxh64:)" +
                    contentHash("mine") + R"("}}})");
  make(request("out", true));
  EXPECT_EQ(text("notes.txt"), "mine");
  for (const char* manifest : {"", "{", "[]", "{\"program\": \"other\"}", "{\"schema\": 1}"}) {
    folder_.write("other/plumbline.json", manifest);
    EXPECT_EQ(refusal(request("other", true)), InputFault::kForeignFiles) << manifest;
  }
}

TEST_F(Output, WhatComesToStandThereMeanwhileStays) {
  make(request("out"), "first");
  OutputFolder out(request("out", true));
  out.write("c.txt", "second");
  folder_.write("out/notes.txt", "mine");
  EXPECT_THROW(out.commit(), InputError);
  EXPECT_EQ(text("out/notes.txt"), "mine");
  EXPECT_EQ(text("out/a/b.txt"), "first");
  OutputFolder late(request("late"));
  make(request("late"), "first");
  EXPECT_THROW(late.commit(), InputError);
  EXPECT_EQ(text("late/a/b.txt"), "first");
}

TEST_F(Output, InputsAreNeverWrittenOver) {
  const auto refused = [&](const std::string& out, const std::string& input) {
    OutputRequest r = request(out, true);
    r.inputs = {folder_.path(input)};
    return refusal(r);
  };
  folder_.write("session/mav0/data.csv", "1");
  make(request("session/result"));
  make(request("out"));
  fs::create_directory_symlink(folder_.path("session"), folder_.path("alias"));
  fs::create_directories(folder_.path("links"));
  fs::create_symlink(folder_.path("out/a/b.txt"), folder_.path("links/target.yaml"));
  using F = InputFault;
  EXPECT_EQ(refused("session", "session"), F::kInputInTheWay);
  EXPECT_EQ(refused("session/mav0/new", "session"), F::kInputInTheWay);
  EXPECT_EQ(refused("alias/new", "session"), F::kInputInTheWay);
  EXPECT_EQ(refused("session/new", "alias"), F::kInputInTheWay);
  EXPECT_EQ(refused("out", "out/a/b.txt"), F::kInputInTheWay);
  EXPECT_EQ(refused("out", "links/target.yaml"), F::kInputInTheWay);
  EXPECT_EQ(refused("out", "links"), F::kInputInTheWay);  // a recording of links
  EXPECT_EQ(refused("out/../out/", "session/../out/a"), F::kInputInTheWay);
  EXPECT_EQ(refused("out", "session"), std::nullopt);
  OutputRequest cached = request("fresh");
  cached.kept = {folder_.path("fresh/cache")};
  EXPECT_EQ(refusal(cached), F::kInputInTheWay);
  cached.kept = {folder_.path()};
  EXPECT_EQ(refusal(cached), std::nullopt);
  // One that cannot be reached, as in another user's home (here: by its name): nobody may need it.
  cached.kept = {folder_.path(std::string(300, 'x') + "/cache")};
  EXPECT_EQ(refusal(cached), std::nullopt);
}

TEST_F(Output, ALinkToAFolderIsFollowed) {
  fs::create_directories(folder_.path("real"));
  fs::create_directory_symlink(folder_.path("real"), folder_.path("link"));
  make(request("link"));
  EXPECT_EQ(text("real/a/b.txt"), "text");
  EXPECT_TRUE(fs::is_symlink(folder_.path("link")));
  fs::create_symlink(folder_.path("nowhere"), folder_.path("dangling"));
  EXPECT_EQ(refusal(request("dangling")), InputFault::kUnwritable);
}

TEST_F(Output, ASiblingUnderTheSameNewParentSurvivesAFailure) {
  {
    OutputFolder failing(request("parent/failing"));
    failing.write("half", "text");
    make(request("parent/sibling"));
  }
  EXPECT_EQ(text("parent/sibling/a/b.txt"), "text");
  EXPECT_FALSE(fs::exists(folder_.path("parent/failing")));
  // And the other way round: the folders above are made again where a sibling took them away.
  {
    std::optional<OutputFolder> failing(request("other/failing"));
    OutputFolder living(request("other/living"));
    failing.reset();
    living.write("a/b.txt", "text");
    living.commit();
  }
  EXPECT_EQ(text("other/living/a/b.txt"), "text");
}

// Workplaces of one process have one process id, as those of two containers may.
TEST_F(Output, EqualProcessIdsDoNotMeetAndLiveWorkplacesStay) {
  OutputFolder first(request("out"));
  OutputFolder second(request("out"));
  EXPECT_NE(first.path(), second.path());
  first.write("first.txt", "first");
  second.write("second.txt", "second");
  first.commit();
  EXPECT_THROW(second.commit(), InputError);
  EXPECT_EQ(text("out/first.txt"), "first");
  EXPECT_FALSE(fs::exists(folder_.path("out/second.txt")));
}

TEST_F(Output, WorkplacesOfDeadProcessesAreRemovedAtTheNextStart) {
  const std::string dead = ".out.partial-dEAd01";
  folder_.write(dead + "/lock", "plumbline\npid 1\nhost h\nstarted s\nfor out\n");
  folder_.write(dead + "/result/half", "text");
  fs::create_directories(folder_.path(".out.partial-dEAd02"));           // no lock yet
  folder_.write(".out.partial-dEAd03/lock", "");                         // nothing in it yet
  folder_.write(".out.partial-notOur/lock", "somebody else's");          // not ours
  folder_.write(".out.partial-notOu2/precious.txt", "somebody else's");  // not ours
  folder_.write(".outer.partial-aaaaaa/lock", "plumbline\nfor outer\n");
  make(request("out"));
  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    left.insert(entry.path().filename());
  }
  EXPECT_EQ(left, (std::set<std::string>{"out", ".out.partial-notOur", ".out.partial-notOu2",
                                         ".outer.partial-aaaaaa"}));
  EXPECT_EQ(text(".out.partial-notOu2/precious.txt"), "somebody else's");
}

// On file systems that cannot exchange, the older result is moved aside for a moment.
TEST_F(Output, AResultThatWasMovedAsideIsPutBackAtTheNextStart) {
  make(request("out"), "first");
  const std::string dead = ".out.partial-dEAd01";
  folder_.write(dead + "/lock", "plumbline\npid 1\nhost h\nstarted s\nfor out\n");
  fs::rename(folder_.path("out"), folder_.path(dead + "/old"));
  EXPECT_EQ(faultOf([&] { const OutputFolder again(request("out", true)); }), std::nullopt);
  EXPECT_EQ(text("out/a/b.txt"), "first");
  EXPECT_FALSE(fs::exists(folder_.path(dead)));
}

TEST_F(Output, AFileReplacesItsLikeOnlyIfThatIsAllowed) {
  const auto written = [&](bool replace) {
    return faultOf([&] { OutputFile(request("page.html", replace), "mark").write("mark 2"); });
  };
  EXPECT_EQ(written(false), std::nullopt);
  EXPECT_EQ(written(false), InputFault::kResultExists);
  EXPECT_EQ(written(true), std::nullopt);
  EXPECT_EQ(text("page.html"), "mark 2");
  folder_.write("page.html", "mine");
  EXPECT_EQ(written(true), InputFault::kForeignFiles);
  EXPECT_EQ(text("page.html"), "mine");
  fs::remove(folder_.path("page.html"));
  ASSERT_EQ(::mkfifo(folder_.path("page.html").c_str(), 0600), 0);
  EXPECT_EQ(written(true), InputFault::kUnwritable);
  EXPECT_TRUE(fs::is_fifo(folder_.path("page.html")));
}

TEST_F(Output, AFileThatCameDuringTheRunIsJudgedAsOneThatWasThere) {
  const auto written = [&](bool replace, const std::string& came) {
    fs::remove(folder_.path("page.html"));
    return faultOf([&] {
      OutputFile out(request("page.html", replace), "mark");
      folder_.write("page.html", came);
      out.write("mark 2");
    });
  };
  EXPECT_EQ(written(false, "mark 1"), InputFault::kResultExists);
  EXPECT_EQ(text("page.html"), "mark 1");
  EXPECT_EQ(written(true, "mine"), InputFault::kForeignFiles);
  EXPECT_EQ(text("page.html"), "mine");
  EXPECT_EQ(written(true, "mark 1"), std::nullopt);
  EXPECT_EQ(text("page.html"), "mark 2");
}

TEST_F(Output, AFileIsNeverAnInputNorInAFolderOfResults) {
  const std::string input = folder_.write("input.json", "mark");
  OutputRequest r = request("alias.json", true);
  r.inputs = {input};
  fs::create_symlink(input, folder_.path("alias.json"));
  const auto refused = [&](const OutputRequest& file) {
    return faultOf([&] { const OutputFile out(file, "mark"); });
  };
  EXPECT_EQ(refused(r), InputFault::kInputInTheWay);
  fs::remove(folder_.path("alias.json"));
  fs::create_hard_link(input, folder_.path("alias.json"));
  EXPECT_EQ(refused(r), InputFault::kInputInTheWay);
  make(request("out"));
  EXPECT_EQ(refused(request("out/page.html", true)), InputFault::kUnwritable);
  EXPECT_EQ(text("input.json"), "mark");
}

TEST_F(Output, PipesDevicesAndFoldersAreNoFilesToRead) {
  ASSERT_EQ(::mkfifo(folder_.path("pipe").c_str(), 0600), 0);
  for (const std::string& path : {folder_.path("pipe"), std::string("/dev/zero"), folder_.path()}) {
    const auto refusal = refusalOf([&] { const MappedFile file(path); });
    ASSERT_TRUE(refusal);
    EXPECT_THAT(refusal->what(), HasSubstr(path == folder_.path() ? "is a folder; expected a file"
                                                                  : "is not a regular file"));
  }
}

TEST(FinalNames, StandInMessages) {
  EXPECT_EQ(
      withFinalNames("/a/.out.partial-x1Y2z3/result/b.txt: full, /c/.d.partial-aaaaaa/result"),
      "/a/out/b.txt: full, /c/d");
  for (const char* other :
       {"a.partial-", ".partial-aaaaaa", "/a/b.partial-aaaaaa/result", "plain"}) {
    EXPECT_EQ(withFinalNames(other), other);
  }
}

TEST_F(Output, DeadTemporariesOfACacheAreRemovedAndOthersStay) {
  folder_.write("key.corners.partial-a1b2c3", "half");
  folder_.write("key.corners", "whole");
  removeDeadTemporaries(folder_.path());
  EXPECT_EQ(files().size(), 1U);
  EXPECT_EQ(text("key.corners"), "whole");
}

}  // namespace
}  // namespace plumbline
