// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr Colour kBandColour{120, 126, 136, 70};
constexpr std::size_t kMostShown = 1500;  // intervals of a plot of readings

using Pick = std::function<Eigen::Vector3d(const ImuIntervalResidual&)>;

LinePlot overTime(const std::string& title, const std::string& label) {
  LinePlot plot;
  plot.frame = {title, {"time since the first frame [s]"}, {label}, 900, 260};
  return plot;
}

/// Three standard deviations of the noisiest axis about zero.
Band noiseBand(const CameraImuStageResult& stage, TimeNs origin,
               MeanReading ImuIntervalResidual::*sensor, double factor) {
  Band band{"3\u03c3 of the samples' noise", {}, {}, {}, kBandColour};
  for (const ImuIntervalResidual& r : stage.imu_residuals) {
    band.x.push_back(secondsBetween(origin, r.t));
    // One band for all three axes, as wide as the noisiest needs.
    band.high.push_back(3 * factor * (r.*sensor).std.maxCoeff());
    band.low.push_back(-band.high.back());
  }
  return band;
}

/// Three axes over time, one value an interval between frames, in the unit that `pick` gives it.
Figure seriesFigure(const CameraImuStageResult& stage, TimeNs origin, LinePlot plot,
                    const Pick& pick, const std::string& caption, const std::string& id) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Colour colour = seriesColour(axis);
    colour.alpha = 200;
    Series series{kAxes[axis], {}, {}, colour, 1};
    for (const ImuIntervalResidual& r : stage.imu_residuals) {
      series.x.push_back(secondsBetween(origin, r.t));
      series.y.push_back(pick(r)[static_cast<Eigen::Index>(axis)]);
    }
    plot.series.push_back(std::move(series));
  }
  return {toSvg(plot, id), caption, true};
}

/// `expected` is the RMS to expect under the assumptions.
Figure normalisedHistogram(const CameraImuStageResult& stage, const std::string& title, int first,
                           int rows, double expected, const std::string& id) {
  constexpr int kBins = 50;
  // In assumed standard deviations.
  constexpr double kReach = 5;
  Histogram plot;
  plot.frame = {title, {"normalised residual [-]"}, {"count"}, 440, 320};
  plot.first = -kReach;
  plot.bin_width = 2 * kReach / kBins;
  plot.series = {{"residuals", std::vector<double>(kBins, 0), {0, 94, 162, 160}}};
  double total = 0;
  for (const ImuIntervalResidual& r : stage.imu_residuals) {
    for (int i = first; i < first + rows; ++i) {
      // Those beyond the bins too: the area below the curve is that of all residuals.
      total += 1;
      const double place = (r.normalised[i] + kReach) / plot.bin_width;
      if (place >= 0 && place < kBins) plot.series[0].counts[static_cast<std::size_t>(place)] += 1;
    }
  }
  // 0: it was not computed, and the assumed noise itself is drawn.
  const double sigma = expected > 0 ? expected : 1;
  plot.curves = {normalCurve(fmt::format("expected, std {:.2f}", sigma), sigma, kReach,
                             total * plot.bin_width)};
  return {toSvg(plot, id),
          "The curve is the density expected under the assumed noise of corners and samples. A "
          "wider distribution: the assumed noise is too small; a narrower one: too large."};
}

Figure biasFigure(const CameraImuStageResult& stage, const std::string& title,
                  const std::string& unit, Eigen::Vector3d ImuState::*bias, TimeNs origin,
                  const std::string& id) {
  LinePlot plot = overTime(title, "bias - mean [" + unit + "]");
  std::vector<double> seconds;
  for (const Frame& frame : stage.frames) seconds.push_back(secondsBetween(origin, frame.t));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ImuState& state : stage.states) mean += state.*bias;
  // Taken off, for a bias walks by far less than its own size.
  mean /= std::max(1.0, static_cast<double>(stage.states.size()));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    Series series{fmt::format("{} (mean {:.4g} {})", kAxes[axis], mean[k], unit),
                  seconds,
                  {},
                  seriesColour(axis),
                  1.4};
    for (const ImuState& state : stage.states) series.y.push_back((state.*bias)[k] - mean[k]);
    plot.series.push_back(std::move(series));
  }
  return {
      toSvg(plot, id),
      "Each axis minus its mean, which the legend states. A bias drifts slowly; one that follows "
      "the motion hides a scale or alignment error of the sensor, or a wrong time offset.",
      true};
}

/// The interval of each run whose reading differs most from its prediction.
std::vector<const ImuIntervalResidual*> shownIntervals(const CameraImuStageResult& stage,
                                                       MeanReading ImuIntervalResidual::*sensor) {
  const auto& all = stage.imu_residuals;
  const std::size_t run = std::max<std::size_t>(1, (all.size() + kMostShown - 1) / kMostShown);
  const auto difference = [&](const ImuIntervalResidual& r) {
    return ((r.*sensor).measured - (r.*sensor).predicted).squaredNorm();
  };
  std::vector<const ImuIntervalResidual*> shown;
  for (std::size_t from = 0; from < all.size(); from += run) {
    // The worst and not the first, so that thinning hides no reading that the noise does not
    // explain.
    const ImuIntervalResidual* most = &all[from];
    for (std::size_t i = from; i < std::min(from + run, all.size()); ++i) {
      if (difference(all[i]) > difference(*most)) most = &all[i];
    }
    shown.push_back(most);
  }
  return shown;
}

/// Of the points of an axis, which are to be told from the line of its prediction.
Colour darker(const Colour& c) {
  const auto part = [](std::uint8_t v) { return static_cast<std::uint8_t>(v * 11 / 20); };
  return {part(c.red), part(c.green), part(c.blue), c.alpha};
}

Figure readingFigure(const CameraImuStageResult& stage, TimeNs origin, LinePlot plot,
                     MeanReading ImuIntervalResidual::*sensor, const std::string& id) {
  const auto shown = shownIntervals(stage, sensor);
  std::vector<double> seconds;
  for (const ImuIntervalResidual* r : shown) seconds.push_back(secondsBetween(origin, r->t));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Colour colour = seriesColour(static_cast<std::size_t>(axis));
    // About the prediction: what the samples' noise lets a reading differ from it.
    Band band{"", seconds, {}, {}, {colour.red, colour.green, colour.blue, 70}};
    Series predicted{kAxes[axis] + std::string(" predicted"), seconds, {}, colour, 1};
    Series measured{
        kAxes[axis] + std::string(" measured"), seconds, {}, darker(colour), 2.4, false, true};
    for (const ImuIntervalResidual* r : shown) {
      const MeanReading& reading = r->*sensor;
      predicted.y.push_back(reading.predicted[axis]);
      measured.y.push_back(reading.measured[axis]);
      band.low.push_back(reading.predicted[axis] - 3 * reading.std[axis]);
      band.high.push_back(reading.predicted[axis] + 3 * reading.std[axis]);
    }
    plot.bands.push_back(std::move(band));
    plot.series.push_back(std::move(predicted));
    plot.series.push_back(std::move(measured));
  }
  return {toSvg(plot, id),
          "Mean over each interval between frames. Points are measured, lines are predicted from "
          "the estimated motion and biases, bands are three standard deviations of the samples' "
          "noise: drag to zoom in until they are visible. The assumed noise does not explain "
          "points outside their band.",
          true};
}

/// Rules go by their names, which documents have too (evaluate/metrics/rules).
const Finding* findingOf(const Verdict& verdict, const std::string& rule) {
  const auto found = std::ranges::find(verdict.findings, rule, &Finding::rule);
  return found == verdict.findings.end() ? nullptr : &*found;
}

/// What the residuals say of the densities assumed, with what the verdict made of it.
std::vector<std::string> noiseRemarks(const ImuNoiseChecks& noise, const Verdict& verdict) {
  if (noise.gyro.redundancy <= 0) return {};  // nobody asked
  return {densityRemark("Gyroscope noise", noise.gyro,
                        findingOf(verdict, "Noise density of the gyroscope")),
          densityRemark("Accelerometer noise", noise.accel,
                        findingOf(verdict, "Noise density of the accelerometer")),
          // No rule judges the walks.
          densityRemark("Gyroscope bias walk", noise.gyro_bias, nullptr),
          densityRemark("Accelerometer bias walk", noise.accel_bias, nullptr),
          noise.pose_pixel_sigma > 0
              ? fmt::format("The noise of the poses corresponds to a corner noise of {:.2f} px.",
                            noise.pose_pixel_sigma)
              : "The IMU's noise hides that of the poses."};
}

std::vector<Block> residualFigures(const CameraImuStageResult& stage, TimeNs origin) {
  if (stage.imu_residuals.empty()) return {};
  const std::string raw =
      "Difference between the integrated samples and the estimated motion, per interval between "
      "frames. Bursts indicate shocks, saturation or missing samples; the band is what the assumed "
      "noise of the samples explains.";
  const ImuNoiseChecks& noise = stage.imu_summary.noise;
  const auto whitened = [](const ImuNoiseCheck& check) {
    return fmt::format(
        "The same divided by the assumed noise. Each frame's own velocity and biases absorb much "
        "of it: about two thirds of the values lie within \u00b1{:.2f} when the assumptions hold.",
        check.expected_rms > 0 ? check.expected_rms : 1);
  };
  // Over the interval: then long and short ones compare, in the unit of the readings.
  const auto gyro = [](const ImuIntervalResidual& r) {
    return Eigen::Vector3d(1e3 * r.rotation_rad / r.dt_s);
  };
  const auto accel = [](const ImuIntervalResidual& r) {
    return Eigen::Vector3d(r.velocity_m_s / r.dt_s);
  };
  // Of `normalised`: rotation from 0, velocity from 3, position from 6, then the walks.
  const auto rows = [](int first) {
    return [first](const ImuIntervalResidual& r) {
      return Eigen::Vector3d(r.normalised.segment<3>(first));
    };
  };
  LinePlot gyro_plot = overTime("Gyroscope residual", "residual [mrad/s]");
  gyro_plot.bands = {noiseBand(stage, origin, &ImuIntervalResidual::gyro, 1e3)};
  LinePlot accel_plot = overTime("Accelerometer residual", "residual [m/s\u00b2]");
  accel_plot.bands = {noiseBand(stage, origin, &ImuIntervalResidual::accel, 1)};
  return {figureBlock("Gyroscope",
                      {seriesFigure(stage, origin, std::move(gyro_plot), gyro, raw, "imu-gyro"),
                       seriesFigure(stage, origin,
                                    overTime("Gyroscope residual, normalised", "residual [-]"),
                                    rows(0), whitened(noise.gyro), "imu-gyro-normalised")}),
          figureBlock("Accelerometer",
                      {seriesFigure(stage, origin, std::move(accel_plot), accel, raw, "imu-accel"),
                       seriesFigure(stage, origin,
                                    overTime("Accelerometer residual, normalised", "residual [-]"),
                                    rows(3), whitened(noise.accel), "imu-accel-normalised")}),
          figureBlock("Distributions",
                      {normalisedHistogram(stage, "Rotation", 0, 3, noise.gyro.expected_rms,
                                           "imu-rotation-histogram"),
                       normalisedHistogram(stage, "Velocity and position", 3, 6,
                                           noise.accel.expected_rms, "imu-velocity-histogram")})};
}

}  // namespace

Section readingsSection(const CameraImuStageResult& stage, TimeNs origin) {
  Section section{"imu-readings", "Measured and predicted readings",
                  "Readings of gyroscope and accelerometer, and the readings that the solution "
                  "predicts, in the IMU's axes."};
  if (stage.imu_residuals.empty()) return section;
  section.blocks = {figureBlock(
      "", {readingFigure(stage, origin, overTime("Angular velocity", "angular velocity [rad/s]"),
                         &ImuIntervalResidual::gyro, "readings-gyro"),
           readingFigure(stage, origin, overTime("Specific force", "specific force [m/s\u00b2]"),
                         &ImuIntervalResidual::accel, "readings-accel")})};
  return section;
}

Section inertialSection(const CameraImuStageResult& stage, TimeNs origin, const Verdict& verdict) {
  return {"imu-residuals", "Inertial residuals",
          "The estimated motion minus that of the inertial samples between two frames, over the "
          "time between them, in the IMU's axes, and the noise densities that these residuals "
          "indicate.",
          residualFigures(stage, origin), noiseRemarks(stage.imu_summary.noise, verdict)};
}

Section biasSection(const CameraImuStageResult& stage, TimeNs origin) {
  std::vector<Figure> figures;
  if (stage.states.size() > 1) {
    figures = {
        biasFigure(stage, "Gyroscope bias", "rad/s", &ImuState::gyro_bias, origin, "bias-gyro"),
        biasFigure(stage, "Accelerometer bias", "m/s\u00b2", &ImuState::accel_bias, origin,
                   "bias-accel")};
  }
  return {
      "biases",
      "Biases",
      "Estimated offsets of the inertial sensors at every frame, in the IMU's axes: a reading is "
      "the true value plus the bias.",
      {figureBlock("", std::move(figures))}};
}

std::string densityRemark(const std::string& sensor, const ImuNoiseCheck& check,
                          const Finding* judged) {
  if (!tellsDensity(check)) {
    return fmt::format("{}: density not known, too few residuals (redundancy {:.0f}).", sensor,
                       check.redundancy);
  }
  std::string text = fmt::format("{}: {:.2f} \u00d7 the assumed density (redundancy {:.0f})",
                                 sensor, check.factor, check.redundancy);
  if (judged == nullptr) return text + ": not judged.";
  if (judged->level == VerdictLevel::kGood) return text + ": within the verdict's bounds.";
  return text + ". " + judged->advice;
}

}  // namespace plumbline::html_internal
