// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/pending_folder.h"

#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "calibrator/base/error.h"

namespace plumbline {

namespace fs = std::filesystem;

PendingFolder::PendingFolder(const fs::path& final_path) : final_(final_path.lexically_normal()) {
  if (!final_.has_filename()) final_ = final_.parent_path();
  std::error_code fault;
  const bool exists = fs::exists(final_, fault);
  if (exists && !(fs::is_directory(final_, fault) && fs::is_empty(final_, fault))) {
    throw InputError(final_.string(), 0,
                     "exists already; expected a new or empty folder; choose another or remove it");
  }
  const fs::path parent = fs::absolute(final_).parent_path();
  pending_ = parent / fmt::format(".{}.partial-{}", final_.filename().string(), getpid());
  create(pending_);
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  if (!pending_.empty()) fs::remove_all(pending_, ignored);
}

void PendingFolder::create(const fs::path& folder) const {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) throw InputError(final_.string(), 0, "cannot be created: " + fault.message());
}

void PendingFolder::commit() {
  std::error_code fault;
  fs::rename(pending_, final_, fault);
  if (fault) throw InputError(final_.string(), 0, "cannot be written: " + fault.message());
  pending_.clear();
}

}  // namespace plumbline
