// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

namespace plumbline {
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
