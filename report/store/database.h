// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/base/error.h"

namespace plumbline::store_internal {

/// Refuses a file that is not ours or of another version; throws SQLite's exception for damage.
void checkOwner(SQLite::Database& db, const std::string& path);

/// Lets `insert` add a run to the store at `path`, within one transaction. A new file is written
/// under a temporary name and renamed when complete. Nothing partial remains; InputError where the
/// file cannot be written.
std::int64_t writeStore(const std::filesystem::path& path,
                        const std::function<std::int64_t(SQLite::Database&)>& insert);

/// Opens an existing store for reading and turns whatever goes wrong into an InputError.
template <class Work>
auto readStore(const std::filesystem::path& path, const Work& work) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path.string(), 0, "no such file; name a store that Plumbline wrote");
  }
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READONLY);
    checkOwner(db, path.string());
    return work(db);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // SQLite's, JSON's and the unpackers' complaints
    throw InputError(path.string(), 0,
                     std::string("is damaged or not a store (") + error.what() +
                         "); expected a store that Plumbline wrote; run the command again that "
                         "made it");
  }
}

}  // namespace plumbline::store_internal
