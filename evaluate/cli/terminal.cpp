// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/terminal.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "calibrator/base/option_check.h"

namespace plumbline {
namespace {

int output_error = 0;  // errno of the first write that failed

bool isColoured() {
  // By the output's own end, not standard error's: a summary in a file has no colours. An empty
  // NO_COLOR counts as unset (https://no-color.org).
  const char* none = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) != 0 && (none == nullptr || *none == '\0');
}

// The colour of a line that states a level: "Verdict: CAUTION", "  bad - Coverage of cam0: ...".
const char* colourOf(std::string_view line) {
  constexpr std::pair<std::string_view, const char*> kColours[] = {
      {"Verdict: GOOD", "\033[32m"},    {"Verdict: COMPLETE", "\033[32m"},
      {"Verdict: CAUTION", "\033[33m"}, {"Verdict: BAD", "\033[31m"},
      {"  caution - ", "\033[33m"},     {"  bad - ", "\033[31m"}};
  for (const auto& [start, colour] : kColours) {
    if (line.starts_with(start)) return colour;
  }
  return nullptr;
}

constexpr int kBarWidth = 30;  // characters
constexpr double kTimeLeftAfter_s = 3;
constexpr std::chrono::seconds kPipeInterval{10};

}  // namespace

void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    // Read-only also in place of standard output, so that writing to it fails and closeOutput() can
    // say so; whoever closed standard error wants no messages.
    (void)open("/dev/null",
               stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);  // the lowest free number
  }
}

void writeOut(std::string_view bytes) {
  const std::size_t written = std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  // The first error is the cause; later ones follow from it.
  if (written != bytes.size() && output_error == 0) output_error = errno;
}

void writeDocument(std::string_view document) {
  if (isatty(STDOUT_FILENO) == 0) return writeOut(document);
  writeOut(shownText(document));
}

void saySummary(std::string_view summary) {
  // Figures that are rounded to zero keep their sign, which says nothing to a person.
  const std::string shown = withoutNegativeZeros(shownText(summary));
  if (!isColoured()) return writeOut(shown);
  std::istringstream lines(shown);
  for (std::string line; std::getline(lines, line);) {
    if (const char* colour = colourOf(line)) {
      // Past "Verdict: ", whose level ends at the next colon.
      const std::size_t end = std::min(line.find(": ", 9), line.size());  // the level, and the rule
      line = colour + line.substr(0, end) + "\033[0m" + line.substr(end);
    }
    writeOut(line + "\n");
  }
}

void writeError(std::string_view bytes) {
  (void)std::fwrite(bytes.data(), 1, bytes.size(), stderr);
}

void complain(std::string_view message) { writeError("plumbline: " + shownLine(message) + "\n"); }

bool closeOutput() {
  const bool faulty = std::ferror(stdout) != 0;
  // What is still in the buffer is written here: a full disk may show now for the first time.
  if (std::fclose(stdout) != 0 && output_error == 0) output_error = errno;
  if (!faulty && output_error == 0) return true;
  complain(fmt::format(
      "standard output cannot be written ({}); expected a terminal, pipe or file with free space",
      output_error != 0 ? std::strerror(output_error) : "write error"));
  return false;
}

ProgressBar::ProgressBar(bool tells_time_left)
    : terminal_(isatty(STDERR_FILENO) != 0), tells_time_left_(tells_time_left) {}

ProgressBar::~ProgressBar() { clear(); }

// As fast as so far; said from some seconds on, when it is worth something.
std::string ProgressBar::timeLeft(double fraction) const {
  if (!tells_time_left_) return "";
  const double spent_s = std::chrono::duration<double>(Clock::now() - begun_).count();
  if (spent_s < kTimeLeftAfter_s || fraction <= 0 || fraction >= 1) return "";
  const long left_s = std::lround(spent_s * (1 - fraction) / fraction);
  if (left_s < 100) return fmt::format(", {} s left", left_s);
  return fmt::format(", {} min left", (left_s + 30) / 60);
}

void ProgressBar::update(const std::string& step, double fraction) {
  // Fractions are of the step, so the time that they are held against is, too.
  if (step != step_) begun_ = Clock::now();
  step_ = step;
  if (!terminal_) {
    if (Clock::now() - told_ < kPipeInterval) return;
    told_ = Clock::now();
    const std::string share = fraction >= 0 ? fmt::format(": {:.0f} %", 100 * fraction) : "";
    return complain(step + share + timeLeft(fraction));
  }
  std::string line = step;
  if (fraction >= 0) {
    const int filled = static_cast<int>(std::lround(kBarWidth * std::clamp(fraction, 0.0, 1.0)));
    line = fmt::format("{:<28} [{}{}] {:3.0f} %{}", step, std::string(filled, '#'),
                       std::string(kBarWidth - filled, ' '), 100 * fraction, timeLeft(fraction));
  }
  if (line == last_) return;
  // To the start of the line, and without the end of a longer one before it.
  writeError("\r\033[K" + shownLine(line));
  last_ = line;
}

void ProgressBar::clear() {
  if (terminal_ && !last_.empty()) writeError("\r\033[K");
  last_.clear();
}

ProgressSink ProgressBar::sink() {
  return [this](const std::string& step, double fraction) { update(step, fraction); };
}

}  // namespace plumbline
