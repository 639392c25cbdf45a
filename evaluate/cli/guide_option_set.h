// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// The guide's options on the command line.
struct GuideOptionSet {
  GuideOptions guide;
  double threshold_bits = 0.2;
  double max_rate_deg_s = 180;
  double max_acceleration_g = 1;
  std::vector<std::string> latencies;  ///< "camera-frame=5"
  double arrival_ms = 50;

  void declare(CLI::App& app);
  /// Checks the values; noise, loss and gravity are the batches'. InputError for values out of
  /// range.
  GuideOptions options(const CameraStageOptions& camera, double gravity_m_s2) const;
};

}  // namespace plumbline
