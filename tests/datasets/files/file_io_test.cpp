// SPDX-License-Identifier: BSD-3-Clause
// Files as they are read and written, whole.
#include "datasets/files/file_io.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

// Up to 64 KB are copied, more are mapped.
TEST(MappedFile, HasTheWholeContentOfAFileOfAnySize) {
  const TemporaryFolder folder;
  for (const std::size_t size : {0, 1, 4096, 65536, 65537, 1 << 20}) {
    std::string content(size, '\0');
    for (std::size_t i = 0; i < size; ++i) content[i] = static_cast<char>(i * 7 + i / 251);
    const MappedFile file(folder.write("file", content));
    EXPECT_TRUE(file.text() == content) << size;
  }
}

TEST(MappedFile, IsOneThatCanBeRead) {
  const TemporaryFolder folder;
  EXPECT_THROW(MappedFile(folder.path("none")), InputError);
  EXPECT_THROW(MappedFile(folder.path()), InputError) << "a folder";
}

TEST(AtomicFile, LeavesNothingBehindWhereItFails) {
  const TemporaryFolder folder;
  EXPECT_THROW(writeFileAtomically(folder.path("none/file"), "text"), InputError);
  std::filesystem::create_directories(folder.path("taken/inside"));
  EXPECT_THROW(writeFileAtomically(folder.path("taken"), "text"), InputError);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(files, 0U);
}

}  // namespace
}  // namespace plumbline
