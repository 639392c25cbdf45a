// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "datasets/files/numbers.h"
#include "evaluate/results/progress.h"

namespace plumbline {

/// Standard streams that the caller closed are occupied: the next file that is opened would take
/// the place of one, and what is printed would go into it. Nothing can be written to a closed
/// output.
void occupyStandardStreams();

/// Writes on standard output as it is, for machines. Faults are kept for closeOutput().
void writeOut(std::string_view bytes);

/// Writes a document on standard output: as it is, for machines; on a terminal as one may show it.
void writeDocument(std::string_view document);

/// Writes a formatted text on standard output, as a terminal may show it.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  writeOut(shownText(fmt::format(format, std::forward<Args>(args)...)));
}

/// Writes the summary of a result; on a terminal the words of its verdict are coloured, unless the
/// variable NO_COLOR is set (https://no-color.org).
void saySummary(std::string_view summary);

/// Writes on standard error as it is. Where that cannot be written, there is nobody to be told.
void writeError(std::string_view bytes);

/// Writes "plumbline: MESSAGE" as one line on standard error.
void complain(std::string_view message);

/// Whether all of standard output was written; says so on standard error where not. After it
/// nothing more can be written.
bool closeOutput();

/// Progress of long work on standard error: one line that is redrawn where that is a terminal, with
/// the time left; elsewhere a line of its own every ten seconds, so that short work stays silent.
class ProgressBar {
 public:
  /// Without the time left where fractions are not of the step that is told: that of a step is by
  /// how long its fraction took.
  explicit ProgressBar(bool tells_time_left = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(const std::string& step, double fraction);
  /// Removes the bar, so that ordinary output may follow.
  void clear();
  ProgressSink sink();

 private:
  using Clock = std::chrono::steady_clock;

  std::string timeLeft(double fraction) const;

  bool terminal_ = false, tells_time_left_ = true;
  std::string last_, step_;
  Clock::time_point begun_ = Clock::now();  ///< of the step
  Clock::time_point told_ = Clock::now();   ///< the last line in a pipe
};

}  // namespace plumbline
