// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "evaluate/statistics/study_statistics.h"

namespace plumbline::test {

inline constexpr double kEffect = 0.82,
                        kPeriod = 0.9;  // factors of method and of the second session

/// Counterbalanced: even participants begin with "free". Each has a level of its own.
inline StudyRecord study(int participants, bool one_order = false) {
  StudyRecord record;
  record.methods = {"free", "guided"};
  record.endpoints = {"held_out_rmse_px"};
  for (int i = 0; i < participants; ++i) {
    const bool free_first = one_order || i % 2 == 0;
    for (const bool guided : {false, true}) {
      StudySession s;
      s.participant = "p" + std::to_string(i);
      s.method = guided ? "guided" : "free";
      s.name = s.participant + "_" + s.method;
      s.period = guided == free_first ? 2 : 1;
      const double noise = 1 + 0.01 * ((7 * i + (guided ? 3 : 0)) % 5 - 2);
      s.held_out_rmse_px =
          (0.2 + 0.05 * i) * noise * (guided ? kEffect : 1) * (s.period == 2 ? kPeriod : 1);
      s.capture_s = (60 + 5 * i) * (guided ? 1.2 : 1);
      record.sessions.push_back(s);
    }
  }
  return record;
}

inline const StudyEffect& effectOn(const StudyRecord& record, const std::string& endpoint) {
  for (const StudyEffect& e : record.statistics.effects) {
    if (e.endpoint == endpoint) return e;
  }
  throw std::runtime_error("no effect on " + endpoint);
}

}  // namespace plumbline::test
