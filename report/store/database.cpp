// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/database.h"

#include "generated/report/embedded.h"

namespace plumbline::store_internal {
namespace {

/// Tables and owner in one transaction: a file that is ours has all of its tables.
void makeSchema(SQLite::Database& db) {
  SQLite::Transaction transaction(db);
  db.exec(embedded::schema());
  setOwner(db, kRunStore);
  transaction.commit();
}

// Version 1 has no runs of kind 'study', and SQLite changes no CHECK of a table in place. Foreign
// keys are off here (SQLite's default), so that rows that refer to the table outlive its exchange.
void bringUpToDate(SQLite::Database& db) {
  // checkOwner() refuses what is newer, so that all else is version 1.
  if (pragma(db, "user_version") == kRunStore.schema_version) return;
  SQLite::Transaction transaction(db);
  db.exec(embedded::migrate_1());
  setOwner(db, kRunStore);
  transaction.commit();
}

std::int64_t writeInto(const std::filesystem::path& path, bool existed,
                       const std::function<std::int64_t(SQLite::Database&)>& insert) {
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    // An existing store is changed in place: SQLite's journal undoes what a killed writer had
    // begun.
    if (existed) {
      checkOwner(db, path.string(), kRunStore);
      bringUpToDate(db);
    } else {
      makeSchema(db);
    }
    // Only now: bringUpToDate() needs them off, and within a transaction the pragma does nothing.
    db.exec("PRAGMA foreign_keys = ON");
    SQLite::Transaction transaction(db);
    const std::int64_t run = insert(db);
    transaction.commit();
    return run;
  } catch (const SQLite::Exception& error) {
    throw InputError(path.string(), 0,
                     std::string("cannot be written as a store (") + error.what() +
                         "); expected a new file or a store in a folder that can be written");
  }
}

}  // namespace

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

void setOwner(SQLite::Database& db, const FileKind& kind) {
  // A pragma takes no bound values.
  db.exec("PRAGMA application_id = " + std::to_string(kind.application_id));
  db.exec("PRAGMA user_version = " + std::to_string(kind.schema_version));
}

void checkOwner(SQLite::Database& db, const std::string& path, const FileKind& kind) {
  // Both are 0 in a file that SQLite made for nobody, an empty one too.
  const int version = pragma(db, "user_version");
  if (pragma(db, "application_id") != kind.application_id || version < 1) {
    throw InputError(path, 0,
                     std::string("is an SQLite file of another program; ") + kind.foreign_cure);
  }
  if (version > kind.schema_version) {
    throw InputError(path, 0,
                     "has store version " + std::to_string(version) + ", this program knows " +
                         std::to_string(kind.schema_version) + "; " + kind.newer_cure);
  }
}

std::int64_t writeStore(const std::filesystem::path& path,
                        const std::function<std::int64_t(SQLite::Database&)>& insert) {
  // A new store gets its name only with its first run in it: a store without runs would pass for
  // one that lost them.
  if (std::filesystem::exists(path)) return writeInto(path, true, insert);
  // A writer that was killed leaves PATH.partial; the next one begins with removing it.
  std::filesystem::path temporary = path;
  temporary += ".partial";
  std::filesystem::remove(temporary);
  try {
    const std::int64_t run = writeInto(temporary, false, insert);
    std::filesystem::rename(temporary, path);
    return run;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

}  // namespace plumbline::store_internal
