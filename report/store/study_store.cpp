// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/study_store.h"

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "generated/report/embedded.h"
#include "report/store/database.h"

namespace plumbline {

struct StudyStore::Memory {
  SQLite::Database db{":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE};
};

namespace {

namespace fs = std::filesystem;
using store_internal::runWith;

constexpr store_internal::FileKind kStudyHistory{
    0x504c5354, 1,  // "PLST"
    "expected a study's history; choose another folder for the study",
    "use the Plumbline that wrote it, or choose another folder"};

/// NULL in the file is NaN in memory: not known.
double numberAt(SQLite::Statement& row, int column) {
  const SQLite::Column value = row.getColumn(column);
  return value.isNull() ? std::nan("") : value.getDouble();
}

std::optional<double> optionalAt(SQLite::Statement& row, int column) {
  const double value = numberAt(row, column);
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

std::string textAt(SQLite::Statement& row, int column) { return row.getColumn(column).getString(); }
int wholeAt(SQLite::Statement& row, int column) { return row.getColumn(column).getInt(); }

// SQLite owns the copy and lets it grow.
void load(SQLite::Database& db, const std::string& bytes) {
  if (bytes.empty()) throw SQLite::Exception("it is empty", SQLITE_NOTADB);
  auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size()));
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, bytes.data(), bytes.size());
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  // Where this fails, SQLite has freed the copy already (FREEONCLOSE).
  const int code =
      sqlite3_deserialize(db.getHandle(), "main", copy, size, size,
                          SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE);
  if (code != SQLITE_OK) throw SQLite::Exception(db.getHandle(), code);
}

std::string readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), 0, "cannot be read; check its permissions");
  return {std::istreambuf_iterator<char>(file), {}};
}

[[noreturn]] void failWriting(const fs::path& path) {
  const std::string why = std::strerror(errno);
  throw InputError(path.string(), 0,
                   "cannot be written (" + why + "); make room or give another folder");
}

/// write() may take a part, and a signal may interrupt it.
void writeAll(int file, const unsigned char* bytes, std::size_t size, const fs::path& path) {
  while (size > 0) {
    const ssize_t written = ::write(file, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) failWriting(path);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

/// A file that goes unless it was given its name.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& final_path)
      : final_(final_path), path_(final_path.string() + ".partial") {
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) failWriting(final_);
  }
  ~TemporaryFile() {
    if (file_ >= 0) ::close(file_);
    if (!placed_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  // Flushed before it is renamed, so that the name never stands for a file that is not on the disk.
  // What a kill leaves under the temporary name, the next save overwrites.
  void write(const unsigned char* bytes, std::size_t size) {
    writeAll(file_, bytes, size, final_);
    if (::fsync(file_) != 0) failWriting(final_);
    if (std::rename(path_.c_str(), final_.c_str()) != 0) failWriting(final_);
    placed_ = true;
  }

 private:
  fs::path final_, path_;
  int file_ = -1;
  bool placed_ = false;
};

/// Does the work; InputError where the history turns out to be damaged.
auto orDamaged(const fs::path& path, const auto& work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw InputError(
        path.string(), 0,
        std::string("is damaged or not a store (") + error.what() +
            "); restore it from a backup, or move it away: the next night begins a new "
            "history");
  }
}

/// The rows of a query, in which `night` is what a night is asked for by, each as `make` has it.
auto rowsOf(SQLite::Database& db, const fs::path& path, const char* query, const auto& make,
            std::optional<int> night = {}) {
  return orDamaged(path, [&] {
    SQLite::Statement row(db, query);
    if (night) row.bind(1, *night);
    std::vector<decltype(make(row))> rows;
    while (row.executeStep()) rows.push_back(make(row));
    return rows;
  });
}

/// The first seven columns, in the order in which both queries name them.
StudyFigure figureAt(SQLite::Statement& row) {
  StudyFigure figure;
  figure.session = textAt(row, 0);
  figure.name = textAt(row, 1);
  figure.unit = textAt(row, 2);
  figure.inputs_key = textAt(row, 3);
  figure.version = textAt(row, 4);
  figure.value = numberAt(row, 5);
  figure.command = textAt(row, 6);
  return figure;
}

}  // namespace

/// Bits, so that -0 is not 0 and no rounding passes for equal; but one NaN is like another, as the
/// file has NULL for all.
bool StudyFigure::operator==(const StudyFigure& other) const {
  const bool same_value = std::memcmp(&value, &other.value, sizeof value) == 0 ||
                          (std::isnan(value) && std::isnan(other.value));
  return same_value && session == other.session && name == other.name && unit == other.unit &&
         inputs_key == other.inputs_key && version == other.version;
}

StudyStore::StudyStore(fs::path path)
    : path_(std::move(path)), memory_(std::make_unique<Memory>()) {
  SQLite::Database& db = memory_->db;
  orDamaged(path_, [&] {
    if (fs::exists(path_)) {
      // SQLite looks into the bytes with the first question: what is no store shows in
      // checkOwner(), damage further on in the check of all pages.
      load(db, readFile(path_));
      store_internal::checkOwner(db, path_.string(), kStudyHistory);
      const std::string found = db.execAndGet("PRAGMA quick_check(1)").getString();
      if (found != "ok") throw SQLite::Exception(found, SQLITE_CORRUPT);
    } else {
      db.exec(embedded::study());
      store_internal::setOwner(db, kStudyHistory);
    }
    db.exec("PRAGMA foreign_keys = ON");
  });
}

StudyStore::~StudyStore() = default;

std::vector<StudyNight> StudyStore::nights() const {
  return rowsOf(memory_->db, path_,
                "SELECT night, date, version, sessions, failed, alarms, seconds, held_out_rmse_px "
                "FROM nights ORDER BY night",
                [](SQLite::Statement& row) {
                  return StudyNight{wholeAt(row, 0),    textAt(row, 1),    textAt(row, 2),
                                    wholeAt(row, 3),    wholeAt(row, 4),   wholeAt(row, 5),
                                    optionalAt(row, 6), optionalAt(row, 7)};
                });
}

std::vector<FigureSpan> StudyStore::figures() const {
  return rowsOf(memory_->db, path_,
                "SELECT session, name, unit, inputs_key, version, value, command, first_night, "
                "last_night FROM figures ORDER BY session, name, first_night",
                [](SQLite::Statement& row) {
                  return FigureSpan{figureAt(row), wholeAt(row, 7), wholeAt(row, 8)};
                });
}

std::vector<StudyAcceptance> StudyStore::accepted() const {
  return rowsOf(memory_->db, path_,
                "SELECT night, session, name, note, date FROM accepted ORDER BY id",
                [](SQLite::Statement& row) {
                  return StudyAcceptance{wholeAt(row, 0), textAt(row, 1), textAt(row, 2),
                                         textAt(row, 3), textAt(row, 4)};
                });
}

std::vector<StudyAlarm> StudyStore::alarms(int night) const {
  return rowsOf(
      memory_->db, path_,
      "SELECT name, session, first_night, kind, was, now, command FROM alarms WHERE night = ? "
      "ORDER BY id",
      [](SQLite::Statement& row) {
        return StudyAlarm{textAt(row, 0),   textAt(row, 1),   wholeAt(row, 2), textAt(row, 3),
                          numberAt(row, 4), numberAt(row, 5), textAt(row, 6)};
      },
      night);
}

std::vector<StudyStepRow> StudyStore::steps() const {
  return rowsOf(memory_->db, path_,
                "SELECT name, key, status, message, command, seconds, peak_mb FROM steps ORDER BY "
                "name",
                [](SQLite::Statement& row) {
                  return StudyStepRow{textAt(row, 0),  textAt(row, 1), textAt(row, 2),
                                      textAt(row, 3),  textAt(row, 4), numberAt(row, 5),
                                      numberAt(row, 6)};
                });
}

// A row whose figure is the same the night after is only prolonged.
void StudyStore::addNight(const StudyNight& night, const std::vector<StudyFigure>& figures) {
  SQLite::Database& db = memory_->db;
  SQLite::Transaction transaction(db);
  SQLite::Statement add(db, "INSERT INTO nights VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  runWith(add, night.night, night.date, night.version, night.sessions, night.failed, night.alarms,
          night.seconds, night.held_out_rmse_px);
  SQLite::Statement find(db,
                         "SELECT session, name, unit, inputs_key, version, value, command, id FROM "
                         "figures WHERE session = ? AND name = ? AND last_night = ?");
  SQLite::Statement prolong(db, "UPDATE figures SET last_night = ?, command = ? WHERE id = ?");
  SQLite::Statement insert(
      db,
      "INSERT INTO figures (session, name, unit, inputs_key, version, value, command, first_night, "
      "last_night) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const StudyFigure& f : figures) {
    find.reset();
    find.bind(1, f.session);
    find.bind(2, f.name);
    // What did not hold on the night before begins anew, even if it is what it once was.
    find.bind(3, night.night - 1);
    // The command is no part of the comparison: the row has that of its last night.
    if (find.executeStep() && figureAt(find) == f) {
      runWith(prolong, night.night, f.command,
              static_cast<std::int64_t>(find.getColumn(7).getInt64()));
    } else {
      runWith(insert, f.session, f.name, f.unit, f.inputs_key, f.version, f.value, f.command,
              night.night, night.night);
    }
  }
  find.reset();
  transaction.commit();
}

void StudyStore::addAlarms(int night, const std::vector<StudyAlarm>& alarms) {
  SQLite::Statement add(memory_->db,
                        "INSERT INTO alarms (night, session, name, kind, first_night, was, now, "
                        "command) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const StudyAlarm& a : alarms) {
    runWith(add, night, a.session, a.metric, a.kind, a.night, a.was, a.is, a.command);
  }
  SQLite::Statement count(memory_->db, "UPDATE nights SET alarms = ? WHERE night = ?");
  runWith(count, static_cast<int>(alarms.size()), night);
}

void StudyStore::setSteps(int night, const std::vector<StudyStepRow>& steps) {
  SQLite::Database& db = memory_->db;
  SQLite::Transaction transaction(db);
  db.exec("DELETE FROM steps");
  SQLite::Statement add(db, "INSERT INTO steps VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const StudyStepRow& s : steps) {
    runWith(add, s.name, s.key, s.status, s.message, s.command, s.seconds, s.peak_mb, night);
  }
  transaction.commit();
}

void StudyStore::accept(const StudyAcceptance& a) {
  SQLite::Statement add(memory_->db,
                        "INSERT INTO accepted (night, session, name, note, date) VALUES (?, ?, ?, "
                        "?, ?)");
  runWith(add, a.night, a.session, a.name, a.note, a.date);
}

void StudyStore::save() const {
  sqlite3_int64 size = 0;
  unsigned char* bytes = sqlite3_serialize(memory_->db.getHandle(), "main", &size, 0);
  if (bytes == nullptr) throw std::bad_alloc();
  const std::unique_ptr<unsigned char, void (*)(void*)> owned(bytes, sqlite3_free);
  TemporaryFile file(path_);
  file.write(bytes, static_cast<std::size_t>(size));
}

}  // namespace plumbline
