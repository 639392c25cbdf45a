// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/terminal.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

namespace plumbline {

namespace {

int output_error = 0;  // errno of the first write that failed

}  // namespace

void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    (void)open("/dev/null",
               stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);  // the lowest free number
  }
}

void writeOut(std::string_view bytes) {
  const std::size_t written = std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  if (written != bytes.size() && output_error == 0) output_error = errno;
}

void writeDocument(std::string_view document) {
  if (isatty(STDOUT_FILENO) == 0) return writeOut(document);
  writeOut(shownText(document));
}

void complain(std::string_view message) {
  const std::string line = "plumbline: " + shownLine(message) + "\n";
  (void)std::fwrite(line.data(), 1, line.size(), stderr);
}

bool closeOutput() {
  const bool faulty = std::ferror(stdout) != 0;
  if (std::fclose(stdout) != 0 && output_error == 0) output_error = errno;
  if (!faulty && output_error == 0) return true;
  complain(
      fmt::format("standard output cannot be written ({}); expected one that takes what is printed",
                  output_error != 0 ? std::strerror(output_error) : "write error"));
  return false;
}

namespace {

constexpr int kBarWidth = 30;

}  // namespace

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::update(const std::string& step, double fraction) {
  if (!terminal_) return;
  std::string line = step;
  if (fraction >= 0) {
    const int filled = static_cast<int>(std::lround(kBarWidth * std::clamp(fraction, 0.0, 1.0)));
    line = fmt::format("{:<28} [{}{}] {:3.0f} %", step, std::string(filled, '#'),
                       std::string(kBarWidth - filled, ' '), 100 * fraction);
  }
  if (line == last_) return;
  fmt::print(stderr, "\r\033[K{}", line);
  std::fflush(stderr);
  last_ = line;
}

void ProgressBar::clear() {
  if (terminal_ && !last_.empty()) fmt::print(stderr, "\r\033[K");
  last_.clear();
}

ProgressSink ProgressBar::sink() {
  return [this](const std::string& step, double fraction) { update(step, fraction); };
}

}  // namespace plumbline
