// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/simulate/random_stream.h"
#include "evaluate/studies/perturbation_study.h"

namespace plumbline {
namespace {

ImuNoise scaled(ImuNoise noise, double factor) {
  noise.gyro_density *= factor;
  noise.gyro_random_walk *= factor;
  noise.accel_density *= factor;
  noise.accel_random_walk *= factor;
  return noise;
}

/// Of every model the last four of Kalibr's projection parameters are fu, fv, pu, pv.
std::vector<CameraCalibration> withFocalLengths(std::vector<CameraCalibration> cameras,
                                                double factor) {
  for (CameraCalibration& camera : cameras) {
    Eigen::VectorXd& projection = camera.intrinsics.projection;
    projection.segment<2>(projection.size() - 4) *= factor;
  }
  return cameras;
}

/// A stream of random numbers for each frame, one number from it: under one seed a larger share
/// leaves out the frames of a smaller one, and more.
Session withoutFrames(const Session& session, const FrameOptions& pairing, const Perturbation& p) {
  // Whole frames: all cameras' views of an instant.
  const auto frames = pairFrames(session.cameras, pairing);
  std::vector<int> kept;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    RandomStream random(p.seed, RandomPurpose::kDroppedFrames, {i});
    if (random.uniform() >= p.amount / 100) kept.push_back(static_cast<int>(i));
  }
  return withFrames(session, frames, kept);
}

/// One number a sample, so that shares are nested as those of frames.
Session withoutSamples(const Session& session, const Perturbation& p) {
  Session kept = session;
  kept.imu->samples.clear();
  RandomStream random(p.seed, RandomPurpose::kDroppedSamples);
  for (const ImuSample& sample : session.imu->samples) {
    if (random.uniform() >= p.amount / 100) kept.imu->samples.push_back(sample);
  }
  return kept;
}

/// The same draws under one seed at every amount, scaled by it.
Session withNoisyCorners(Session session, const Perturbation& p) {
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    RandomStream random(p.seed, RandomPurpose::kCornerNoise, {c});
    for (ImageView& view : session.cameras[c].views) {
      for (Corner& corner : view.corners) {
        corner.uv.x() += p.amount * random.normal();
        corner.uv.y() += p.amount * random.normal();
      }
    }
  }
  return session;
}

}  // namespace

std::string unitOf(PerturbationKind kind) {
  if (kind == PerturbationKind::kImuShift) return "ms";
  if (kind == PerturbationKind::kNoiseDensities) return "x";
  return kind == PerturbationKind::kCornerNoise ? "px" : "%";
}

bool needsImu(PerturbationKind kind) {
  return kind == PerturbationKind::kImuShift || kind == PerturbationKind::kNoiseDensities ||
         kind == PerturbationKind::kDroppedImu;
}

bool isRandom(PerturbationKind kind) {
  return kind == PerturbationKind::kDroppedFrames || kind == PerturbationKind::kDroppedImu ||
         kind == PerturbationKind::kCornerNoise;
}

void Perturbation::check() const {
  const bool dropped =
      kind == PerturbationKind::kDroppedFrames || kind == PerturbationKind::kDroppedImu;
  const std::string unit = unitOf(kind);
  const char* expected = nullptr;
  // First, for a NaN passes all comparisons below.
  if (!std::isfinite(amount)) {
    expected = "a number";
  } else if (dropped && (amount < 0 || amount >= 100)) {
    expected = "from 0 to below 100";
  } else if (unit == "%" && amount <= -100) {
    expected = "above -100";
  } else if (unit == "x" && amount <= 0) {
    expected = "above 0";
  } else if (unit == "px" && amount < 0) {
    expected = "0 or above";
  }
  if (expected == nullptr) return;
  throw InputError(fmt::format("{} {} {}: expected {}", name(), amount, unit, expected));
}

PerturbedInputs perturbed(const StudyInputs& inputs, const Perturbation& p) {
  p.check();
  const Session& session = *inputs.session;
  PerturbedInputs out{std::nullopt, inputs.camera, inputs.camera_imu,
                      !inputs.cameras_fixed && !needsImu(p.kind)};
  switch (p.kind) {
    case PerturbationKind::kImuShift:
      // Beside a shift that the study itself was asked for.
      out.camera_imu.imu_shift_ns += static_cast<TimeNs>(std::llround(p.amount * 1e6));
      break;
    case PerturbationKind::kTargetSize:
      out.session = session;
      out.session->target.tag_size *= 1 + p.amount / 100;
      break;
    case PerturbationKind::kNoiseDensities:
      out.camera_imu.noise = scaled(inputs.camera_imu.noise.value_or(session.imu->noise), p.amount);
      break;
    case PerturbationKind::kInitialIntrinsics:
      // All else of the start is the base's solution, so that the focal lengths alone are tested.
      out.camera.start = withFocalLengths(inputs.cameras, 1 + p.amount / 100);
      break;
    case PerturbationKind::kDroppedFrames:
      out.session = withoutFrames(session, inputs.camera.frames, p);
      break;
    case PerturbationKind::kDroppedImu:
      out.session = withoutSamples(session, p);
      break;
    case PerturbationKind::kCornerNoise:
      out.session = withNoisyCorners(session, p);
      break;
  }
  return out;
}

}  // namespace plumbline
