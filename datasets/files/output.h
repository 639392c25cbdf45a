// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

class Workplace;

/// Absolute, without dots, with its last name at the end: of "out/" and "out/." that is "out".
std::filesystem::path namedPath(const std::filesystem::path& path);

/// What a command is about to write, and what it must not touch.
struct OutputRequest {
  std::string path;      ///< of the folder or file, as its user wrote it
  std::string kind;      ///< of the result, for its manifest: "calibration"
  std::string version;   ///< of the program, for its manifest
  bool replace = false;  ///< an earlier output of this program may be replaced
  /// Files and folders that are read. Names that are not there are left to who reads them.
  std::vector<std::string> inputs;
  /// Folders that are kept for later runs, such as a cache: the output may lie in one, not hold it.
  std::vector<std::string> kept;
};

/// A folder of results, made in a Workplace and moved to its name when it is complete, with the
/// manifest (manifest.h) that marks it as ours.
///
/// The constructor refuses, before any work is done and leaving all as it is: a path that is an
/// input, lies in one or holds one (by device and inode, and so through links); a folder with
/// anything in it that no manifest of ours lists, or that was changed since; an earlier result of
/// ours, of any kind, unless it may be replaced (kResultExists); a path that cannot be
/// written. Then it makes the workplace. Whatever stops the work, the older result stays as it was
/// until the new one replaces it at once.
class OutputFolder {
 public:
  explicit OutputFolder(OutputRequest request);
  ~OutputFolder();  ///< removes what was made, unless committed
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write before commit().
  const std::filesystem::path& path() const { return made_; }
  /// The folder's name after commit(), as its user wrote it.
  const std::string& name() const { return request_.path; }
  /// Writes a file, and the folders above it. Throws InputError where it cannot.
  void write(const std::string& name, std::string_view text) const;
  /// Adds the manifest and gives the folder its name. Throws InputError where another result, or
  /// something else, has come to stand there meanwhile.
  void commit();

 private:
  void replaceOlder();

  OutputRequest request_;
  std::filesystem::path final_;  // absolute, links resolved
  std::filesystem::path made_;
  std::unique_ptr<Workplace> workplace_;
};

/// One file as a result, under the same rules: an existing file is replaced only if that is
/// allowed, it is no input, and it holds `mark`, which every output of its kind does. Files in a
/// result folder belong to it and are never replaced.
class OutputFile {
 public:
  OutputFile(OutputRequest request, const std::string& mark);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws InputError where what stands there by now must not be replaced.
  void write(std::string_view content);

 private:
  OutputRequest request_;
  std::string mark_;
  std::filesystem::path final_;
  std::unique_ptr<Workplace> workplace_;
};

}  // namespace plumbline
