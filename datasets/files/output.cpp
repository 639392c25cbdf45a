// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/output.h"

#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/manifest.h"
#include "datasets/files/workplace.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// What a name stands for, links followed.
std::optional<struct stat> statusOf(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

bool isSame(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// Whether `path` is `folder` or lies in it, however either is written.
// By device and inode at every level upwards: names would not tell of links.
bool isWithinExisting(const fs::path& path, const struct stat& folder) {
  for (fs::path at = resolvedAsFar(path);; at = at.parent_path()) {
    const auto status = statusOf(at);
    if (status && isSame(*status, folder)) return true;
    if (!at.has_relative_path()) return false;
  }
}

BadInput refusal(InputFault code, const std::string& path, const std::string& what,
                 const std::string& cure = "choose another output") {
  return badInput(path, {code, what, "", cure});
}

void refuseHolding(const OutputRequest& request, const fs::path& final_path,
                   const std::string& input) {
  const auto output = statusOf(final_path);
  // One that is not there yet holds nothing but by name.
  const bool holds =
      output ? isWithinExisting(input, *output) : isWithin(resolvedAsFar(input), final_path);
  if (!holds) return;
  throw refusal(InputFault::kInputInTheWay, request.path,
                fmt::format("contains {}, an input or a cache, which is never removed", input));
}

void refuseInputs(const OutputRequest& request, const fs::path& final_path) {
  for (const std::string& kept : request.kept) refuseHolding(request, final_path, kept);
  for (const std::string& input : request.inputs) {
    const auto status = statusOf(input);
    if (status && isWithinExisting(final_path, *status)) {
      const auto output = statusOf(final_path);
      const bool same = output && isSame(*output, *status);
      const std::string what = !same                   ? "is inside " + input + ","
                               : request.path == input ? "is"
                                                       : "is " + input + ",";
      throw refusal(InputFault::kInputInTheWay, request.path,
                    what + " an input, which is never written to");
    }
    refuseHolding(request, final_path, input);
    std::error_code error;  // a recording may be a folder of links
    for (fs::recursive_directory_iterator it(input, error), end; !error && it != end;
         it.increment(error)) {
      if (it->is_symlink(error)) refuseHolding(request, final_path, it->path().string());
    }
  }
}

// Absolute, links resolved as far as it is there.
fs::path finalPath(const OutputRequest& request) {
  if (request.path.empty())
    throw BadInput(InputFault::kBadOption, "the name of the output is empty");
  const fs::path path = namedPath(request.path);
  std::error_code error;
  if (fs::is_symlink(fs::symlink_status(path, error)) && !fs::exists(path, error)) {
    throw refusal(InputFault::kUnwritable, request.path, "is a broken link");
  }
  fs::path resolved = fs::weakly_canonical(path, error);
  // A folder above that went between two looks at it, with a sibling's failure that had made it.
  for (int again = 0; again < 10 && error == std::errc::no_such_file_or_directory; ++again) {
    resolved = fs::weakly_canonical(path, error);
  }
  if (error) {
    throw refusal(InputFault::kUnwritable, request.path,
                  fmt::format("cannot be reached ({})", error.message()));
  }
  return resolved;
}

/// Linux 5.8 and later tell; before, it shows when the folder is to be exchanged, which then fails.
bool isMountPoint(const fs::path& path) {
  struct statx status {};
  if (::statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS, &status) != 0) return false;
  return (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

// A folder is replaced by another one: it must be no more than a name in the folder above.
void refuseFixedFolder(const OutputRequest& request, const fs::path& path) {
  const auto folder = statusOf(path);
  const auto here = statusOf(".");
  if (!folder) return;
  const char* what = nullptr;
  if (isMountPoint(path)) {
    what = "is a mount point, which cannot be replaced as a whole";
  } else if (here && isSame(*folder, *here)) {
    what = "is the working folder, which cannot be replaced as a whole";
  }
  if (what == nullptr) return;
  throw refusal(InputFault::kUnwritable, request.path, what,
                "give a new folder, such as one in it");
}

void refuseForeign(const fs::path& folder, const Manifest& manifest) {
  const auto foreign = firstForeign(folder, manifest);
  if (!foreign) return;
  throw refusal(InputFault::kForeignFiles, foreign->path.string(),
                foreign->changed ? "was changed after plumbline wrote it"
                                 : "was not written by plumbline, which never removes it",
                "move it elsewhere, or choose another output");
}

/// Nothing there, an empty folder, or a result of ours that is as it was written and may be
/// replaced.
void refuseFolder(const OutputRequest& request, const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  if (!fs::is_directory(path, error)) {
    throw refusal(InputFault::kUnwritable, request.path, "is not a folder; expected a folder");
  }
  refuseFixedFolder(request, path);
  if (fs::is_empty(path, error)) return;
  // A foreign file is named even where there is no manifest: the user needs to know which one it
  // is.
  const auto manifest = readManifest(path);
  refuseForeign(path, manifest.value_or(Manifest{}));
  if (!manifest) {
    throw refusal(InputFault::kForeignFiles, path.string(),
                  "contains a manifest that plumbline did not write");
  }
  if (request.replace) return;
  throw refusal(InputFault::kResultExists, request.path,
                fmt::format("contains an earlier result ({})", manifest->kind));
}

void refuseFile(const OutputRequest& request, const std::string& mark, const fs::path& path) {
  if (readManifest(path.parent_path())) {
    throw refusal(InputFault::kUnwritable, request.path,
                  "is inside a results folder, whose files belong together");
  }
  const auto status = statusOf(path);
  if (!status) return;
  if (!S_ISREG(status->st_mode)) {
    throw refusal(InputFault::kUnwritable, request.path,
                  "is not a regular file; expected the name of a regular file",
                  "give another name");
  }
  if (MappedFile(path.string()).text().find(mark) == std::string_view::npos) {
    throw refusal(InputFault::kForeignFiles, request.path,
                  "was not written by plumbline, which never replaces it",
                  "move it elsewhere, or give another name");
  }
  if (request.replace) return;
  throw refusal(InputFault::kResultExists, request.path, "exists already", "give another name");
}

BadInput unmoved(const OutputRequest& request, int error) {
  return refusal(InputFault::kUnwritable, request.path,
                 fmt::format("cannot be written ({})", std::strerror(error)),
                 "check the folder, its permissions and the disk");
}

}  // namespace

fs::path namedPath(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  // "out/" ends in an empty name.
  return normal.has_filename() ? normal : normal.parent_path();
}

// Dead workplaces go first: one may hold the older result that its process had moved aside, and all
// that follows judges what then stands at the name.
OutputFolder::OutputFolder(OutputRequest request)
    : request_(std::move(request)), final_(finalPath(request_)) {
  removeDeadWorkplaces(final_);
  refuseInputs(request_, final_);
  refuseFolder(request_, final_);
  workplace_ = std::make_unique<Workplace>(final_, request_.path);
  made_ = workplace_->result();
  if (::mkdir(made_.c_str(), 0777) != 0) throw unmoved(request_, errno);
}

OutputFolder::~OutputFolder() = default;

void OutputFolder::write(const std::string& name, std::string_view text) const {
  writeNewFile(made_, name, text);
}

void OutputFolder::commit() {
  write(kManifestFile, manifestText(manifestOf(made_, request_.version, request_.kind)));
  switch (workplace_->place()) {
    case Workplace::Moved::kDone:
      break;
    case Workplace::Moved::kInTheWay:
      replaceOlder();
      break;
    case Workplace::Moved::kFailed:
      throw unmoved(request_, errno);
  }
  workplace_->done();
  workplace_.reset();
}

// What stands there may have changed since the constructor looked, until it is out of others'
// sight: it is judged again then, and put back unless it is all ours.
void OutputFolder::replaceOlder() {
  refuseFolder(request_, final_);
  if (!workplace_->exchange()) throw unmoved(request_, errno);
  const auto manifest = readManifest(made_);
  const auto foreign = firstForeign(made_, manifest.value_or(Manifest{}));
  if (manifest && !foreign) return;
  if (!workplace_->exchange()) throw unmoved(request_, errno);
  refuseFolder(request_, final_);
  throw unmoved(request_, EBUSY);
}

OutputFile::OutputFile(OutputRequest request, const std::string& mark)
    : request_(std::move(request)), mark_(mark), final_(finalPath(request_)) {
  removeDeadWorkplaces(final_);
  refuseInputs(request_, final_);
  refuseFile(request_, mark_, final_);
  workplace_ = std::make_unique<Workplace>(final_, request_.path);
}

OutputFile::~OutputFile() = default;

void OutputFile::write(std::string_view content) {
  const fs::path made = workplace_->result();
  writeNewFile(made.parent_path(), made.filename(), content);
  const auto moved = workplace_->place();
  if (moved == Workplace::Moved::kFailed) throw unmoved(request_, errno);
  if (moved == Workplace::Moved::kInTheWay) {
    // It may have come there since the constructor looked.
    refuseFile(request_, mark_, final_);
    if (!request_.replace) throw unmoved(request_, EEXIST);  // it has gone again
    if (!workplace_->replaceFile()) throw unmoved(request_, errno);
  }
  workplace_->done();
  workplace_.reset();
}

}  // namespace plumbline
