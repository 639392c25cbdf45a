// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/database.h"

#include <array>
#include <limits>

#include "generated/report/embedded.h"

namespace plumbline::store_internal {
namespace {

namespace sql = embedded;

constexpr int kApplicationId = 0x504c4d42;  // "PLMB": tells our files from other SQLite files
constexpr int kSchemaVersion = 3;

/// Scripts that lift a file from version i to i + 1.
const std::array<const std::string& (*)(), kSchemaVersion> kMigrations = {
    &sql::schema_v1, &sql::schema_v2, &sql::schema_v3};

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

void migrate(SQLite::Database& db) {
  const int version = pragma(db, "user_version");
  if (version == kSchemaVersion) return;
  db.exec("PRAGMA foreign_keys = OFF");  // a table that is made anew would take its children along
  SQLite::Transaction transaction(db);
  for (int v = version; v < kSchemaVersion; ++v) {
    db.exec(kMigrations[static_cast<std::size_t>(v)]());
  }
  if (SQLite::Statement(db, "PRAGMA foreign_key_check").executeStep()) {
    throw SQLite::Exception("rows without their run");
  }
  db.exec("PRAGMA application_id = " + std::to_string(kApplicationId));
  db.exec("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  transaction.commit();
}

std::int64_t writeInto(const std::filesystem::path& path, bool existed,
                       const std::function<std::int64_t(SQLite::Database&)>& insert) {
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    if (existed) checkOwner(db, path.string());
    migrate(db);
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
                     "has store version " + std::to_string(version) +
                         ", this program knows up to " + std::to_string(kSchemaVersion) +
                         "; use a newer Plumbline");
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

void bindNumber(SQLite::Statement& statement, int column, double value) {
  if (value == value) {
    statement.bind(column, value);
  } else {
    statement.bind(column);
  }
}

double number(const SQLite::Column& column) {
  return column.isNull() ? std::numeric_limits<double>::quiet_NaN() : column.getDouble();
}

}  // namespace plumbline::store_internal
