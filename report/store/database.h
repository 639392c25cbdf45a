// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>

#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/base/error.h"

namespace plumbline::store_internal {

/// A kind of SQLite file of ours, told from others' by what SQLite keeps in its head.
struct FileKind {
  int application_id = 0;
  int schema_version = 1;
  const char* foreign_cure = "";  ///< what to do about a file of another program
  const char* newer_cure = "";    ///< and about one of a newer Plumbline
};

int pragma(SQLite::Database& db, const char* name);

/// Makes a new file one of this kind.
void setOwner(SQLite::Database& db, const FileKind& kind);

/// Refuses a file that is not of this kind or of a newer version; throws SQLite's exception for
/// damage.
void checkOwner(SQLite::Database& db, const std::string& path, const FileKind& kind);

/// Binds a value to a statement's column, counted from 1: NULL, not known, for what is no finite
/// number.
template <class T>
void bindValue(SQLite::Statement& statement, int column, const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value)) return statement.bind(column);
  }
  statement.bind(column, value);
}

inline void bindValue(SQLite::Statement& statement, int column,
                      const std::optional<double>& value) {
  bindValue(statement, column, value.value_or(std::nan("")));
}

/// Runs a statement once more with these values.
template <class... Values>
void runWith(SQLite::Statement& statement, const Values&... values) {
  statement.reset();
  int column = 0;
  (bindValue(statement, ++column, values), ...);
  statement.exec();
}

/// A store of runs.
inline constexpr FileKind kRunStore{0x504c4d42, 2,  // "PLMB"
                                    "name a store of Plumbline's",
                                    "use the Plumbline that wrote it, or write a new store"};

/// Lets `insert` add a run to the store at `path`, within one transaction. A new file is written
/// under a temporary name and renamed when complete. Nothing partial remains; InputError where the
/// file cannot be written.
std::int64_t writeStore(const std::filesystem::path& path,
                        const std::function<std::int64_t(SQLite::Database&)>& insert);

/// Opens an existing store for reading and turns whatever goes wrong into an InputError.
auto readStore(const std::filesystem::path& path, const auto& work) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path.string(), 0, "no such file; name a store that Plumbline wrote");
  }
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READONLY);
    checkOwner(db, path.string(), kRunStore);
    return work(db);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // SQLite's, JSON's and the unpackers' complaints
    throw InputError(path.string(), 0,
                     std::string("cannot be read as a store (") + error.what() +
                         "); it is damaged, no store, or one of another version of Plumbline; run "
                         "the command again that made it");
  }
}

}  // namespace plumbline::store_internal
