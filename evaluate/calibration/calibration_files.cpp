// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/images/image_io.h"
#include "datasets/session/target.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/results/text.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

std::string numbers(const Eigen::VectorXd& values) {
  return joined(values, [](double value) { return fmt::format("{:.6g}", value); });
}

void addErrors(Text& text, const char* name, const StageSummary& s) {
  add(text, "{}: RMSE {:.4f} px (mean {:.4f}, median {:.4f}), {} of {} corners, {} of {} views\n",
      name, s.reprojection.rmse_px, s.reprojection.mean_px, s.reprojection.median_px,
      s.corners_used, s.corners_offered, s.views_used, s.views_offered);
}

/// Where the lenses begin in a camera-IMU stage that has estimated the cameras again; none in one
/// that held them. Cameras' own time offsets are no parameters of lenses.
std::optional<Eigen::Index> firstLens(const CameraImuStageResult& stage) {
  const std::vector<std::string>& names = stage.summary.covariance.names;
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return name.starts_with(stage.cameras.front().name + ".");
  });
  return found == names.end() ? std::nullopt : std::optional(found - names.begin());
}

// Deviations robust where they are known, the formal ones beside them: of the camera-IMU stage
// where that has estimated the cameras again.
void addCameras(Text& text, const CalibrationRecord& record) {
  const StageSummary* stage = record.camera ? &record.camera->summary : nullptr;
  // In both stages one lens stands behind the other; the camera stage's parameters begin with them.
  Eigen::Index first = 0;
  if (const auto joint = record.camera_imu ? firstLens(*record.camera_imu) : std::nullopt) {
    stage = &record.camera_imu->summary;
    first = *joint;
  }
  for (const CameraCalibration& camera : record.cameras()) {
    const Intrinsics& k = camera.intrinsics;
    add(text, "  {} {}-{}  [{}]  [{}]\n", camera.name, toString(k.projection_model),
        toString(k.distortion_model), numbers(k.projection), numbers(k.distortion));
    if (!camera.intrinsics_std) continue;
    const Eigen::Index size = camera.intrinsics_std->size();
    if (stage && stage->robust_std) {
      add(text, "       std [{}] (robust)\n", numbers(stage->robust_std->segment(first, size)));
    }
    add(text, "       formal std [{}]\n", numbers(*camera.intrinsics_std));
    first += size;
  }
}

// How well the recording determines where far points fall in each image.
void addUncertainty(Text& text, const std::vector<ImageMap>& maps) {
  for (const ImageMap& map : maps) {
    std::vector<double> known;
    for (const double std : map.values) {
      // NaN at pixels where the lens model has no ray.
      if (std::isfinite(std)) known.push_back(std);
    }
    if (known.empty()) continue;
    const double most = *std::max_element(known.begin(), known.end());
    add(text, "  {} projection of far points: std {:.2g} px in the median, {:.2g} px at most\n",
        map.camera, median(known), most);
  }
}

// What the camera-IMU stage had to do without; nothing where it used all.
void addLeftOut(Text& text, const CameraImuStageResult& stage) {
  if (stage.frames_without_imu + stage.frames_without_pose + stage.imu_gaps == 0) return;
  add(text,
      "  {} frames used; not used: {} without IMU samples, {} without a pose; gaps in the IMU: "
      "{}\n",
      stage.frames.size(), stage.frames_without_imu, stage.frames_without_pose, stage.imu_gaps);
}

// Of T_SC0 and the time offset: robust where it is known, the formal one beside it.
void addImu(Text& text, const CameraImuStageResult& stage) {
  const ImuCalibration& imu = stage.imu;
  const auto deviations = [](const Vector6d& s) {
    return fmt::format("[{:.2f}, {:.2f}, {:.2f}] mm, [{:.4f}, {:.4f}, {:.4f}] deg", 1e3 * s[0],
                       1e3 * s[1], 1e3 * s[2], kDegrees * s[3], kDegrees * s[4], kDegrees * s[5]);
  };
  const auto& robust = stage.summary.robust_std;
  const Eigen::Vector3d mm = 1e3 * imu.T_SC0.t;
  add(text, "  T_SC0 translation [{:.2f}, {:.2f}, {:.2f}] mm", mm.x(), mm.y(), mm.z());
  // One that has estimated the cameras again has all in one stage.
  const bool joint = firstLens(stage).has_value();
  if (robust) {
    add(text, ", std {} (robust{})", deviations(robust->head<6>()),
        joint ? "" : ", through both stages");
  }
  if (imu.T_SC0_std) {
    add(text, "{}{}", robust ? "; formal " : ", std ", deviations(*imu.T_SC0_std));
  }
  add(text, "\n  time offset {:+.4f} ms", 1e3 * imu.timeOffset());
  if (robust) add(text, ", std {:.4f} ms", 1e3 * (*robust)[6]);
  if (imu.time_offset_std_s) {
    add(text, "{}{:.4f} ms", robust ? "; formal " : ", std ", 1e3 * *imu.time_offset_std_s);
  }
  add(text, " (t_imu = t_cam + offset)\n");
}

// Which lens models were chosen, why, and what they leave of frames that they were not fitted to.
void addModels(Text& text, const std::vector<ModelChoice>& models) {
  for (const ModelChoice& m : models) {
    add(text, "Lens model of {}: {}-{} ({})", m.camera, toString(m.projection),
        toString(m.distortion),
        m.reason == ModelReason::kStated
            ? "as stated; none predicts held-out frames significantly better"
        : m.reason == ModelReason::kSmallest
            ? "the smallest of those that predict held-out frames best"
        : m.reason == ModelReason::kTangential
            ? "the smallest with tangential terms of those that predict held-out frames best"
        : m.reason == ModelReason::kCommon
            ? "that of all cameras together, which costs this one less than 1 %"
            : "others were not tested, or this recording does not determine them");
    for (const ModelCandidate& c : m.candidates) {
      if (c.projection != m.projection || c.distortion != m.distortion) continue;
      if (!std::isfinite(c.held_out_px)) continue;
      add(text, ", {:.4f} px there", c.held_out_px);
    }
    add(text, "\n");
  }
}

// What was found of the board, where that was asked for.
void addTarget(Text& text, const TargetFit& fit, bool kept) {
  // With a file `flat` is the board of the file, whatever its shape, and the other one is the shape
  // that this session alone would have.
  if (fit.finding == TargetFinding::kKnown && !fit.isJudged()) {
    add(text, "Target: known from another session; not tested by this recording\n");
    return;
  }
  if (fit.finding == TargetFinding::kKnown || fit.finding == TargetFinding::kOther) {
    add(text,
        "Target: {}; held-out frames {:.4f} px with the given shape, {:.4f} px with an estimated "
        "one\n",
        fit.finding == TargetFinding::kKnown ? "known from another session"
                                             : "not that of the given file",
        fit.flat_held_out_px, fit.held_out_px);
    return;
  }
  if (fit.finding == TargetFinding::kAsStated) {
    add(text, "Target: as target.yaml states\n");
    return;
  }
  if (fit.finding != TargetFinding::kBent) {
    add(text, "Target: assumed as stated ({})\n", toString(fit.finding));
    return;
  }
  add(text,
      "Target: {:.2f} mm RMS deviation from the even grid{}; held-out frames {:.4f} px with the "
      "estimated shape, {:.4f} px without\n",
      1e3 * fit.shape.rms(), kept ? ", estimated with the cameras" : ", not applied",
      fit.shapeHeldOutPx(), fit.flat_held_out_px);
}

template <class StageResult>
void addRows(Text& text, const char* name, const StageResult& stage) {
  for (const CornerResidual& r : stage.residuals) {
    add(text, "{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{}\n", name, stage.frames[r.frame].t,
        stage.cameras[r.camera].name, r.corner_id, r.uv.x(), r.uv.y(), r.error.x(), r.error.y(),
        r.used ? 1 : 0);
  }
}

std::string residualsTable(const CalibrationRecord& record) {
  Text text;
  add(text, "#stage,timestamp [ns],camera,corner_id,u [px],v [px],e_u [px],e_v [px],used\n");
  if (record.camera) addRows(text, "camera", *record.camera);
  if (record.camera_imu) addRows(text, "camera_imu", *record.camera_imu);
  return fmt::to_string(text);
}

constexpr int kWidest = 800;  // [px]
constexpr int kQuality = 60;

/// Empty where the file cannot be read: its corners may come from the cache.
std::optional<ViewImage> imageOf(const std::string& path, int camera, TimeNs t) {
  try {
    const GrayImage image = readGrayImage(path);
    const int factor = (image.width() + kWidest - 1) / kWidest;
    return ViewImage{camera, t, factor, encodeJpeg(shrunk(image, factor), kQuality)};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<ResultFile> calibrationFiles(const CalibrationRecord& record, bool residuals) {
  Calibration calibration{record.cameras(), {}};
  if (record.camera_imu) calibration.imu = record.camera_imu->imu;
  const auto& imu = calibration.imu;
  std::vector<ResultFile> files{
      {"calibration.json", documentOf(record)},
      {imu ? "camchain-imucam.yaml" : "camchain.yaml", kalibrCamchainText(calibration)}};
  if (imu) files.push_back({"imu.yaml", kalibrImuText(imu->noise, imu->rostopic)});
  if (!record.target.shape.isFlat()) {
    files.push_back({kTargetShapeFile, targetShapeText(record.target)});
  }
  if (residuals) files.push_back({"residuals.csv", residualsTable(record)});
  return files;
}

std::string calibrationSummary(const CalibrationRecord& record) {
  Text text;
  if (record.camera) addErrors(text, "Cameras", record.camera->summary);
  if (record.camera) addModels(text, record.camera->models);
  if (record.camera && record.camera->target_fit) {
    const TargetFit& fit = *record.camera->target_fit;
    // The stage has the estimated terms themselves where it has applied them.
    addTarget(text, fit, record.camera->target.terms == fit.shape.terms);
  }
  addCameras(text, record);
  addUncertainty(text, record.projection_uncertainty);
  if (record.camera_imu) {
    addErrors(text, "Camera-IMU", record.camera_imu->summary);
    addLeftOut(text, *record.camera_imu);
    addImu(text, *record.camera_imu);
  } else {
    add(text, "Camera-IMU: not calibrated (no imu0 in the recording, or the IMU is disabled)\n");
  }
  add(text, "{}", verdictText(record.verdict));
  return fmt::to_string(text);
}

void addViewImages(const LoadedSession& loaded, CalibrationRecord& record) {
  record.view_images.clear();
  const bool any = std::any_of(loaded.images.begin(), loaded.images.end(),
                               [](const auto& of_camera) { return !of_camera.empty(); });
  if (!any || (!record.camera && !record.camera_imu)) return;
  // The page ranks the views of the camera stage, and those of the other where the cameras were
  // given.
  const auto& frames = record.camera ? record.camera->frames : record.camera_imu->frames;
  const auto& residuals = record.camera ? record.camera->residuals : record.camera_imu->residuals;
  const std::vector<ViewErrors> views = viewErrors(residuals);
  const std::vector<std::size_t> order = worstFirst(views);
  for (std::size_t i = 0; i < std::min(kWorstViews, order.size()); ++i) {
    const ViewErrors& v = views[order[i]];
    const auto camera = static_cast<std::size_t>(v.camera);
    const Frame& frame = frames[static_cast<std::size_t>(v.frame)];
    const auto& images = loaded.images[camera];
    if (images.empty()) continue;
    const auto& file = images[static_cast<std::size_t>(frame.view[camera])];
    if (auto image = imageOf(file.path, v.camera, frame.t)) {
      record.view_images.push_back(std::move(*image));
    }
  }
}

}  // namespace plumbline
