// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/database.h"

#include "generated/report/embedded.h"

namespace plumbline::store_internal {
namespace {

constexpr int kApplicationId = 0x504c4d42;  // "PLMB": tells our files from other SQLite files
constexpr int kSchemaVersion = 2;

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

void makeSchema(SQLite::Database& db) {
  SQLite::Transaction transaction(db);
  db.exec(embedded::schema());
  db.exec("PRAGMA application_id = " + std::to_string(kApplicationId));
  db.exec("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  transaction.commit();
}

// Version 1 has no runs of kind 'study', and SQLite changes no CHECK of a table in place. Foreign
// keys are off here (SQLite's default), so that rows that refer to the table outlive its exchange.
void bringUpToDate(SQLite::Database& db) {
  if (pragma(db, "user_version") == kSchemaVersion) return;
  SQLite::Transaction transaction(db);
  db.exec(embedded::migrate_1());
  db.exec("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  transaction.commit();
}

std::int64_t writeInto(const std::filesystem::path& path, bool existed,
                       const std::function<std::int64_t(SQLite::Database&)>& insert) {
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    if (existed) {
      checkOwner(db, path.string());
      bringUpToDate(db);
    } else {
      makeSchema(db);
    }
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

void checkOwner(SQLite::Database& db, const std::string& path) {
  const int version = pragma(db, "user_version");
  if (pragma(db, "application_id") != kApplicationId || version < 1) {
    throw InputError(path, 0, "is an SQLite file of another program; name a store of Plumbline's");
  }
  if (version > kSchemaVersion) {
    throw InputError(path, 0,
                     "has store version " + std::to_string(version) + ", this program knows " +
                         std::to_string(kSchemaVersion) +
                         "; use the Plumbline that wrote it, or write a new store");
  }
}

std::int64_t writeStore(const std::filesystem::path& path,
                        const std::function<std::int64_t(SQLite::Database&)>& insert) {
  if (std::filesystem::exists(path)) return writeInto(path, true, insert);
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
