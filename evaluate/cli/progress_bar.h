// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/results/progress.h"

namespace plumbline {

/// A one-line progress bar on standard error where that is a terminal; silent in a pipe.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(const std::string& step, double fraction);
  /// Removes the bar, so that ordinary output may follow.
  void clear();
  ProgressSink sink();

 private:
  bool terminal_ = false;
  std::string last_;
};

}  // namespace plumbline
