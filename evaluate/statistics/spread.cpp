// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibrator/base/statistics/distributions.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/statistics/study_statistics.h"

namespace plumbline {
namespace {

// Of two sessions, one degree of freedom, true deviations give ratios from 0.03 to 2.2 (95 %):
// nothing would stand out. Of three it is 0.16 to 1.9.
constexpr std::size_t kLeastSessions = 3;
constexpr double kTail = 0.025;

/// A session's estimates by name; the last stage's where both have one.
using Estimates = std::map<std::string, ParameterEstimate>;

Estimates estimatesOf(const StudySession& session) {
  Estimates estimates;
  for (const ParameterEstimate& e : session.estimates) estimates.insert_or_assign(e.name, e);
  return estimates;
}

/// The rotation vector that a name such as "T_SC0.rx" belongs to; empty where it is none, or the
/// others are missing.
std::optional<Eigen::Vector3d> rotationOf(const Estimates& estimates, const std::string& name) {
  const std::size_t dot = name.find(".r");
  if (dot == std::string::npos || dot + 3 != name.size()) return std::nullopt;
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    const auto found = estimates.find(name.substr(0, dot + 2) + static_cast<char>('x' + axis));
    if (found == estimates.end()) return std::nullopt;
    vector[axis] = found->second.value;
  }
  return vector;
}

/// The value, for rotations its first session's plus the step in the left tangent from there: the
/// deviations are of that tangent, while components of Log(R) are of none.
double comparedValue(const Estimates& estimates, const Estimates& first, const std::string& name) {
  const auto rotation = rotationOf(estimates, name), reference = rotationOf(first, name);
  if (!rotation || !reference) return estimates.at(name).value;
  const Eigen::Vector3d step = logSO3(expSO3(*rotation) * expSO3(*reference).transpose());
  return first.at(name).value + step[name.back() - 'x'];
}

/// The lens model of the camera that a parameter is of, by its coefficients ("k1 k2 p1 p2"): under
/// another model the same name is another quantity. "" where it is no camera's.
std::string lensOf(const Estimates& estimates, const std::string& name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || name.starts_with("T_") || name.starts_with("time_offset")) {
    return "";
  }
  const std::string camera = name.substr(0, dot + 1);
  std::string lens;
  for (const auto& [other, e] : estimates) {
    if (!other.starts_with(camera)) continue;
    const std::string own = other.substr(dot + 1);
    if (own != "fu" && own != "fv" && own != "pu" && own != "pv") {
      lens += (lens.empty() ? "" : " ") + own;
    }
  }
  return lens.empty() ? "no distortion" : lens;
}

struct Sample {
  std::vector<double> values, stated;
  std::vector<std::string> sessions;
  std::string unit;
};

/// chi^2 = sum ((x_i - mean) / s_i)^2 about the mean weighted by 1 / s_i^2, with n - 1 degrees of
/// freedom; the farthest session is the one with the largest term.
StudySpread studySpreadOf(const std::string& method, const std::string& parameter,
                          const Sample& x) {
  StudySpread s;
  s.method = method;
  s.parameter = parameter;
  s.unit = x.unit;
  s.sessions = static_cast<int>(x.values.size());
  double weights = 0;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double weight = 1 / (x.stated[i] * x.stated[i]);
    weights += weight;
    s.mean += weight * x.values[i];
  }
  s.mean /= weights;
  double chi2 = 0, most = -1;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double square = std::pow((x.values[i] - s.mean) / x.stated[i], 2);
    chi2 += square;
    if (!(square > most)) continue;
    most = square;
    s.farthest = x.sessions[i];
  }
  const auto dof = static_cast<double>(s.sessions - 1);
  s.std = sampleStatistics(x.values, 1).std;
  // The root of the mean variance: what the spread would be on average, were the deviations true.
  s.stated_std = sampleStatistics(x.stated).rmse;
  s.ratio = std::sqrt(chi2 / dof);
  // Of sqrt(chi^2 / dof) under true deviations and normal errors, 95 %.
  s.low = std::sqrt(chiSquaredQuantile(dof, kTail) / dof);
  s.high = std::sqrt(chiSquaredTailQuantile(dof, kTail) / dof);
  return s;
}

}  // namespace

std::vector<StudySpread> spreadOverSessions(const StudyRecord& record) {
  std::vector<StudySpread> spread;
  for (const std::string& method : record.methods) {
    std::map<std::string, std::map<std::string, Sample>> samples;  // by name and lens model
    std::map<std::string, Estimates> firsts;
    for (const StudySession& session : record.sessions) {
      if (session.method != method || session.status != StudyStatus::kOk) continue;
      const Estimates estimates = estimatesOf(session);
      for (const auto& [name, e] : estimates) {
        const double stated = e.shownStd();
        // Without a stated deviation there is nothing to compare with.
        if (!(stated > 0) || !std::isfinite(stated) || !std::isfinite(e.value)) continue;
        const Estimates& first = firsts.try_emplace(name, estimates).first->second;
        Sample& sample = samples[name][lensOf(estimates, name)];
        sample.unit = e.unit;
        sample.values.push_back(comparedValue(estimates, first, name));
        sample.stated.push_back(stated);
        sample.sessions.push_back(session.name);
      }
    }
    for (const auto& [name, lenses] : samples) {
      for (const auto& [lens, sample] : lenses) {
        if (sample.values.size() < kLeastSessions) continue;
        const std::string shown = lenses.size() > 1 ? fmt::format("{} ({})", name, lens) : name;
        spread.push_back(studySpreadOf(method, shown, sample));
      }
    }
  }
  return spread;
}

}  // namespace plumbline
