// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "report/records/study_record.h"

namespace plumbline {

/// A figure of one night, with what it was made from and by.
struct StudyFigure {
  std::string session;  ///< empty: of the study
  std::string name;     ///< "held_out_rmse_px/eval01"
  std::string unit;
  std::string inputs_key, version;  ///< of the step that made it
  double value = 0;                 ///< NaN: not known
  std::string command;              ///< to make it by hand

  bool operator==(const StudyFigure& other) const;  ///< equal bits of the value; command aside
};

/// A figure as it was from one night to another.
struct FigureSpan {
  StudyFigure figure;
  int first_night = 0, last_night = 0;
};

/// How a step ended, for who asks the store.
struct StudyStepRow {
  std::string name, key, status, message, command;
  double seconds = 0, peak_mb = 0;
};

/// A change that was looked at and found right: from that night on the figure is judged by what it
/// is since then. Empty: every session, every figure.
struct StudyAcceptance {
  int night = 0;
  std::string session, name, note, date;
};

/// study.sqlite: the history of a study. It is read into memory, and written whole: to a temporary
/// name, flushed, and renamed, so that a process that is killed leaves the older one, and no lock
/// of a network file system is relied upon. One process at a time may change it (see NightLock).
class StudyStore {
 public:
  /// Reads the file; an empty history where there is none. InputError for files that are damaged,
  /// of another program, or of a newer version.
  explicit StudyStore(std::filesystem::path path);
  ~StudyStore();
  StudyStore(const StudyStore&) = delete;
  StudyStore& operator=(const StudyStore&) = delete;

  std::vector<StudyNight> nights() const;   ///< oldest first
  std::vector<FigureSpan> figures() const;  ///< by session, name and night
  std::vector<StudyAcceptance> accepted() const;
  std::vector<StudyAlarm> alarms(int night) const;
  std::vector<StudyStepRow> steps() const;

  /// Adds a night that comes after all others, with its figures.
  void addNight(const StudyNight& night, const std::vector<StudyFigure>& figures);
  /// How many alarms a night has is kept with it.
  void addAlarms(int night, const std::vector<StudyAlarm>& alarms);
  /// The steps of the last night, in place of those before.
  void setSteps(int night, const std::vector<StudyStepRow>& steps);
  void accept(const StudyAcceptance& acceptance);

  /// Gives the file what was changed; InputError where it cannot be written.
  void save() const;

 private:
  struct Memory;
  std::filesystem::path path_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace plumbline
