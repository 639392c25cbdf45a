// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "datasets/files/file_io.h"
#include "datasets/images/image_io.h"
#include "evaluate/odometry/judged_run.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// Reads images, and counts those that it cannot.
class FrameReader {
 public:
  FrameReader(const OdometrySequence& sequence, const RigModel& rig, double most_skipped)
      : sequence_(sequence), rig_(rig) {
    std::size_t images = 0;
    // Only the cameras that are used: the calibration may have fewer than the sequence.
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) images += sequence.images[c].size();
    allowed_ = static_cast<std::size_t>(most_skipped * static_cast<double>(images));
  }

  /// Of all cameras at the stamp of an image of camera 0; empty ones where there is none.
  std::vector<GrayImage> at(const ImageFile& first) {
    std::vector<GrayImage> images{read(first, 0)};
    for (std::size_t c = 1; c < rig_.cameras.size(); ++c) {
      const ImageFile* image = imageAt(sequence_.images[c], first.t);
      images.push_back(image != nullptr ? read(*image, c) : GrayImage());
    }
    return images;
  }

  std::size_t skipped() const { return skipped_; }

 private:
  GrayImage read(const ImageFile& file, std::size_t camera) {
    GrayImage image;
    try {
      image = readGrayImage(file.path);
    } catch (const InputError& error) {
      if (++skipped_ > allowed_) {
        throw InputError(file.path, 0,
                         fmt::format("{} images are missing or damaged, more than {} may be; the "
                                     "last one: {}",
                                     skipped_, allowed_, error.what()));
      }
      return {};
    }
    // No share of such images is allowed: it is not one image that is damaged.
    const Resolution& stated = rig_.cameras[camera].resolution;
    if (image.width() == stated.width && image.height() == stated.height) return image;
    throw InputError(
        file.path, 0,
        fmt::format(
            "is {}x{}, and the calibration states {}x{} for this camera: it belongs to another rig",
            image.width(), image.height(), stated.width, stated.height));
  }

  const OdometrySequence& sequence_;
  const RigModel& rig_;
  std::size_t allowed_ = 0, skipped_ = 0;
};

/// Without a front end: the sequence says what the cameras saw, and it may have more of them than
/// the calibration, or than were asked for.
FrameTracks seenBy(const RigModel& rig, FrameTracks frame) {
  std::erase_if(frame.points, [&](const TrackPoint& p) {
    return p.camera >= static_cast<int>(rig.cameras.size());
  });
  return frame;
}

/// When, after the first image, and why track was lost.
std::string lossText(const BuiltinRun& run, TimeNs start) {
  std::string text;
  for (const OdometryLossEvent& loss : run.result.losses) {
    text += fmt::format("{}{:.2f} s ({})", text.empty() ? "" : ", ", secondsBetween(start, loss.t),
                        toString(loss.cause));
  }
  return text;
}

/// What needs no truth, and the frames' times.
void addConsistency(const BuiltinRun& run, OdometryRunRecord& r) {
  // 0 stands for "no sighting" there, and would be a perfect fit here.
  if (run.result.stereo_px > 0) r.stereo_px = run.result.stereo_px;
  if (run.result.innovation_px > 0) r.innovation_px = run.result.innovation_px;
  if (run.frame_s.empty()) return;
  r.frame_p50_ms = 1e3 * quantile(run.frame_s, 0.5);
  r.frame_p95_ms = 1e3 * quantile(run.frame_s, 0.95);
  r.frame_p99_ms = 1e3 * quantile(run.frame_s, 0.99);
  r.frame_max_ms = 1e3 * *std::max_element(run.frame_s.begin(), run.frame_s.end());
}

/// What the odometry would choose for the time offset, and for T_SC0; that it gives none is said,
/// before the additional runs where the evaluated one, of these innovations, has too few seconds.
void addHint(const OdometryPlan& plan, const OdometryRequest& request,
             const std::vector<FrameInnovation>& innovations, OdometryRunRecord& r,
             std::vector<std::string>& remarks) {
  const Calibration calibration = withNoise(plan);
  r.offset_calibrated_s = calibration.imu->timeOffset();
  const std::string too_few = tooFewBlocks(innovations, plan.sequence->duration_s());
  if (!too_few.empty()) {
    remarks.push_back(kNoHint + too_few);
    return;
  }
  const auto run = [&](const Eigen::VectorXd& change) {
    return runBuiltin(*plan.sequence, changed(calibration, change), request.builtin)
        .result.innovations;
  };
  // Several plans already occupy the cores.
  const bool alone = request.sequences.size() * request.calibrations.size() == 1;
  const auto [hint, none] = calibrationHint(request.hint, run, alone ? request.threads : 1);
  if (!hint) {
    remarks.push_back(kNoHint + none);
    return;
  }
  r.offset_hint_s = *r.offset_calibrated_s + hint->change[0];
  r.offset_hint_std_s = hint->std[0];
  if (request.hint != HintKind::kExtrinsics) return;
  r.T_SC0_hint = Vector6d(hint->change.tail<6>());
  r.T_SC0_hint_std = Vector6d(hint->std.tail<6>());
}

}  // namespace

void BuiltinOptions::check() const {
  odometry.check();
  tracker.check();
  requireOption(cameras >= 0, "cameras", cameras, "0 or more");
  requireWithin(0, 1, "most_skipped", most_skipped);
  requirePositive("corner_sigma_px", corner_sigma_px);
}

BuiltinRun runBuiltin(const OdometrySequence& sequence, const Calibration& calibration,
                      const BuiltinOptions& options) {
  options.check();
  const RigModel rig = RigModel::of(calibration, options.cameras);
  if (rig.cameras.size() > sequence.images.size()) {
    throw InputError(sequence.root.string(), 0,
                     fmt::format("has {} cameras, the calibration {}: it belongs to another rig",
                                 sequence.images.size(), rig.cameras.size()));
  }
  const Stopwatch clock;
  OdometryOptions odometry_options = options.odometry;
  // A board's corners are found better than features of a scene (0.3 px for 0.7); the points of
  // tracks.csv are taken for as good as those of images.
  if (sequence.points == PointSource::kCorners) {
    odometry_options.pixel_sigma = options.corner_sigma_px;
  }
  Odometry odometry(rig, sequence.samples, odometry_options);
  FrameReader reader(sequence, rig, options.most_skipped);
  FeatureTracker tracker(rig, options.tracker);
  std::optional<TimeNs> last;
  const auto tracked = [&](const ImageFile& first) -> std::optional<FrameTracks> {
    const std::vector<GrayImage> images = reader.at(first);
    // Tracks live in the first camera; the others' sightings belong to them.
    if (images[0].empty()) return std::nullopt;
    std::vector<GrayImageView> views;
    for (const GrayImage& image : images) views.push_back(image.view());
    // The gyroscope's rotation since the last image that was seen, from which tracking starts.
    const Eigen::Matrix3d turn = last ? odometry.expectedRotation(*last, first.t)
                                      : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    last = first.t;
    return tracker.track(first.t, views, turn);
  };
  BuiltinRun run;
  run.frames = sequence.images[0].size();
  for (std::size_t k = 0; k < run.frames; ++k) {
    const Stopwatch of_frame;
    const auto frame =
        sequence.tracks.empty() ? tracked(sequence.images[0][k]) : seenBy(rig, sequence.tracks[k]);
    if (!frame) continue;
    odometry.step(*frame);
    run.frame_s.push_back(of_frame.seconds());
  }
  run.result = odometry.result();
  run.skipped = reader.skipped();
  run.seconds = clock.seconds();
  return run;
}

std::vector<StampedPose> posesOf(const OdometryResult& result) {
  std::vector<StampedPose> poses;
  for (const OdometryPose& pose : result.poses) {
    poses.push_back({pose.t, pose.state.T_FS.t, pose.state.T_FS.quaternion()});
  }
  return poses;
}

std::string tumText(const std::vector<StampedPose>& poses) {
  Text text;
  add(text, "# t [s] x y z [m] qx qy qz qw: IMU in the odometry's world, camera clock\n");
  for (const StampedPose& pose : poses) {
    // In whole numbers: at today's epoch a double of seconds is a multiple of 0.24 us.
    // The sign once: both parts of a stamp before 0 have it, and the first may be 0.
    const TimeNs t = std::abs(pose.t);
    add(text, "{}{}.{:09} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
        pose.t < 0 ? "-" : "", t / 1'000'000'000, t % 1'000'000'000, pose.p.x(), pose.p.y(),
        pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
  }
  return fmt::to_string(text);
}

OdometryOutcome runBuiltinPlan(const OdometryPlan& plan, const OdometryRequest& request,
                               const fs::path& out) {
  const Calibration calibration = withNoise(plan);
  const BuiltinRun run = runBuiltin(*plan.sequence, calibration, request.builtin);
  OdometryOutcome outcome;
  OdometryRunRecord& r = outcome.record;
  r.system = "builtin";
  r.seconds = run.seconds;
  r.frames = run.frames;
  r.frames_skipped = run.skipped;
  r.losses = run.result.losses.size();
  r.mean_landmarks = run.result.mean_landmarks;
  addConsistency(run, r);
  if (request.hint != HintKind::kNone) {
    addHint(plan, request, run.result.innovations, r, outcome.remarks);
  }
  if (run.skipped > 0) {
    outcome.remarks.push_back(
        fmt::format("{} images are missing or damaged and were skipped", run.skipped));
  }
  if (!plan.calibration->noise_known && !plan.sequence->noise) {
    const ImuNoise& assumed = calibration.imu->noise;
    outcome.remarks.push_back(fmt::format(
        "neither calibration nor sequence states the IMU's noise densities: {:.3g} rad/s/sqrt(Hz) "
        "and {:.3g} m/s^2/sqrt(Hz) were assumed; give an imu.yaml",
        assumed.gyro_density, assumed.accel_density));
  }
  if (run.result.poses.empty()) {
    outcome.problem = "never initialised: images and IMU did not determine the motion";
    return outcome;
  }
  outcome.poses = posesOf(run.result);
  // Also where it lost track: the file is there to look at, and the run is failed.
  writeNewFile(out, pathOf(plan), tumText(outcome.poses));
  if (r.losses > 0) {
    outcome.problem = fmt::format("lost track {} times and continued from another pose: at {}",
                                  r.losses, lossText(run, plan.sequence->images[0].front().t));
  }
  return outcome;
}

}  // namespace plumbline
