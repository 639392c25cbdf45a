// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

// Field lists (see fields.h) of what calibrations and sessions are made of, and of statistics.

/// What each term is, where it is positive.
inline constexpr std::array<const char*, kTargetTerms> kTargetTermTexts = {
    "wider along x than along y",
    "loss of right angles",
    "displacement along x, with x^2",
    "along x, with x y",
    "along x, with y^2",
    "along y, with x^2",
    "along y, with x y",
    "along y, with y^2",
    "height, with x^2",
    "height, with x y",
    "height, with y^2",
    "apparent increase of the tags' size at unchanged pitch"};

/// Values of the terms under their names.
void targetTermFields(auto& v, TargetTerms& terms) {
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    v(kTargetTermNames[j], terms[static_cast<Eigen::Index>(j)], "m", kTargetTermTexts[j]);
  }
}

void fields(auto& v, TargetShape& s) {
  v.group("terms", [&](auto& g) { targetTermFields(g, s.terms); });
  v("covariance", s.covariance, "of the terms, in their order [m^2]; absent: assumed exact");
  v("higher", s.higher,
    "terms of degrees 3 and 4 [m]: 9 along x, 9 along y, 9 of height; absent: none");
  v("higher_std", s.higher_std, "their standard deviations [m]; absent: assumed exact");
  v("corners", s.corners,
    "remainders of single corners [m]: x, y, height of corner 0, then of corner 1; absent: none");
}

void fields(auto& v, AprilGrid& g) {
  v("rows", g.rows, "tags along y");
  v("cols", g.cols, "tags along x");
  v("tag_size", g.tag_size, "m", "outer edge of a tag's black border");
  v("spacing", g.spacing, "1", "gap between tags over `tag_size`");
  v("shape", g.shape, "deviation of the board from the flat and even grid");
}

inline auto elements(Resolution& r) { return std::tie(r.width, r.height); }

inline auto elements(Corner& c) { return std::tie(c.id, c.uv.x(), c.uv.y()); }

void fields(auto& v, ImuNoise& n) {  // Kalibr's words
  v("gyroscope_noise_density", n.gyro_density, "rad/s/sqrt(Hz)", "white noise of the gyroscope");
  v("gyroscope_random_walk", n.gyro_random_walk, "rad/s^2/sqrt(Hz)", "of its bias");
  v("accelerometer_noise_density", n.accel_density, "m/s^2/sqrt(Hz)",
    "white noise of the accelerometer");
  v("accelerometer_random_walk", n.accel_random_walk, "m/s^3/sqrt(Hz)", "of its bias");
  v("update_rate", n.rate_hz, "Hz", "nominal sample rate");
}

void fields(auto& v, Frame& f) {
  v("t_ns", f.t, "ns", "stamp of the frame, camera 0's clock");
  v("view", f.view, "of each camera, its view in the session; -1: none");
}

template <class V>
void fields(V& v, CameraCalibration& c) {
  Intrinsics& k = c.intrinsics;
  v("name", c.name, "as in the session");
  v.ifSet("rostopic", c.rostopic, "absent where unknown");
  v("model", k.projection_model, "Kalibr's words: `pinhole`, `omni`, `eucm`, `ds`");
  v("distortion", k.distortion_model, "`none`, `radtan`, `equidistant`, `fov`, `rational`");
  v("resolution", k.resolution, "px", "`[width, height]`");
  v("intrinsics", k.projection, "px",
    "`[fu, fv, pu, pv]`, the model's own before them; (0, 0) is the centre of the first pixel");
  v("distortion_coeffs", k.distortion, "1",
    "radtan `[k1, k2, p1, p2]`, equidistant `[k1 ... k4]`, fov `[w]`, rational "
    "`[k1, k2, p1, p2, k3 ... k6]`");
  std::optional<Eigen::VectorXd> projection_std, distortion_std;  // parts of intrinsics_std
  if (c.intrinsics_std) {
    projection_std = c.intrinsics_std->head(k.projection.size()).eval();
    distortion_std = c.intrinsics_std->tail(k.distortion.size()).eval();
  }
  v("intrinsics_std", projection_std, "px", "absent for cameras that were given and kept fixed");
  v("distortion_coeffs_std", distortion_std, "1", "likewise");
  if constexpr (V::kReads) {
    c.intrinsics_std.reset();
    if (projection_std && distortion_std) {
      c.intrinsics_std.emplace(projection_std->size() + distortion_std->size());
      *c.intrinsics_std << *projection_std, *distortion_std;
    }
  }
  v("T_C0Ci", c.T_C0Ci, "m", "4 x 4, rows: p_C0 = T_C0Ci p_Ci");
  v("T_C0Ci_std", c.T_C0Ci_std, "m, rad",
    "3 of the translation, 3 of the left tangent of the rotation; absent for camera 0");
}

/// Of every camera [s], none for those that are synchronised with camera 0; empty where all are.
inline std::vector<std::optional<double>> ownOffsets(const TimeOffsets& offsets) {
  std::vector<std::optional<double>> own;
  for (std::size_t c = 0; haveOwnOffsets(offsets) && c < offsets.size(); ++c) {
    const bool listed = c == 0 || offsets[c].estimated;
    own.push_back(listed ? std::optional(offsets[c].s) : std::nullopt);
  }
  return own;
}
/// The inverse, with camera 0's.
inline TimeOffsets timeOffsets(double camera0_s, const std::vector<std::optional<double>>& own) {
  TimeOffsets offsets{{camera0_s, false}};
  for (std::size_t c = 1; c < own.size(); ++c) {
    offsets.push_back({own[c].value_or(camera0_s), own[c].has_value()});
  }
  return offsets;
}

template <class V>
void fields(V& v, ImuCalibration& i) {
  v("T_SC0", i.T_SC0, "m",
    "4 x 4, rows: p_S = T_SC0 p_C0 (inverse of Kalibr's `T_cam_imu` of cam0)");
  v("T_SC0_std", i.T_SC0_std, "m, rad",
    "3 of the translation, 3 of the left tangent of the rotation");
  double offset = i.timeOffset();
  v("time_offset_s", offset, "s", "t_d of camera 0: t_imu = t_cam + t_d");
  v("time_offset_std_s", i.time_offset_std_s, "s", "its standard deviation");
  auto own = ownOffsets(i.time_offsets);
  v.ifSet("camera_time_offsets_s", own,
          "t_d of every camera [s]; only where their stamps differ; null: as camera 0");
  if constexpr (V::kReads) i.time_offsets = timeOffsets(offset, own);
  v("gravity_m_s2", i.gravity_m_s2, "m/s^2", "assumed magnitude");
  v.ifSet("rostopic", i.rostopic, "absent where unknown");
  v("noise", i.noise, "assumed densities, named as in Kalibr's `imu.yaml`");
}

void fields(auto& v, Calibration& c) {
  v("cameras", c.cameras, "in the session's order; camera 0 is the reference");
  v("imu", c.imu, "the IMU's calibration, where there is one");
}

void fields(auto& v, ParameterName& p) {
  v("name", p.name, "`cam0.fu`, `cam0.k1`, `T_C0C1.tx`, `T_SC0.rx`, `time_offset`, ...");
  v("unit", p.unit, "`px`, `-`, `m`, `rad`, `s`");
}

template <class V>
void fields(V& v, ParameterCovariance& c) {
  std::vector<ParameterName> parameters;
  for (std::size_t i = 0; i < c.names.size(); ++i) parameters.push_back({c.names[i], c.units[i]});
  v("parameters", parameters, "of the rows; everything else is marginalised");
  v("matrix", c.matrix, "rows; formal: it follows from `assumptions`, no factor is fitted");
  if constexpr (V::kReads) c = parameterCovariance(parameters, c.matrix);
}

void fields(auto& v, ErrorStatistics& s) {
  v("rmse_px", s.rmse_px, "px", "sqrt(mean |e|^2) over corners, e = measured - projected");
  v("mean_px", s.mean_px, "px", "mean of |e|");
  v("median_px", s.median_px, "px", "median of |e|");
  v("std_px", s.std_px, "px", "standard deviation of |e| (divisor n): rmse^2 = mean^2 + std^2");
  v("axis_mean_px", s.axis_mean_px, "px", "`[u, v]`: mean of the components of e");
  v("axis_std_px", s.axis_std_px, "px", "`[u, v]`: their standard deviation (divisor n)");
  v("corners", s.count, "1", "number of corners of these figures");
}

template <class V>
void fields(V& v, SampleStatistics& s) {
  v("n", s.n, "1", "number of samples; without any, the figures below are absent");
  if (s.n == 0 && !V::kAll) return;
  v("rmse", s.rmse, kSameUnit, "sqrt(sse / n)");
  v("mean", s.mean, kSameUnit, "sum x / n");
  v("median", s.median, kSameUnit, "mean of the middle two where n is even");
  v("std", s.std, kSameUnit, "sqrt(sum (x - mean)^2 / (n - ddof))");
  v("min", s.min, kSameUnit, "least");
  v("max", s.max, kSameUnit, "greatest");
  v("sse", s.sse, "sum x^2");
  v.group("percentiles", [&](auto& g) {
    constexpr std::array<const char*, kPercents.size()> kNames = {"1", "5", "25", "75", "95", "99"};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      g(kNames[i], s.percentiles[i], kSameUnit, "percentile, by linear interpolation");
    }
  });
}

}  // namespace plumbline
