// SPDX-License-Identifier: BSD-3-Clause
// Readers of calibrations and of what Kalibr leaves beside them.
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/fields/json_fields.h"
#include "calibrator/simulate/rig.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/calibration/kalibr_writer.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/calibration/yac_text.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

/// The rigs of the simulator; with a camera of every model, without an IMU.
std::vector<Calibration> calibrations() {
  std::vector<Calibration> all;
  for (const std::string& rig : simulatedRigNames()) all.push_back(simulatedRig(rig).calibration);
  Calibration models = all.front();
  models.imu.reset();
  models.cameras.resize(1);
  const auto add = [&](ProjectionModel model, std::initializer_list<double> leading) {
    CameraCalibration camera = models.cameras.front();
    camera.name = "cam" + std::to_string(models.cameras.size());
    camera.T_C0Ci.t.x() = 0.1 * static_cast<double>(models.cameras.size());
    Eigen::VectorXd& p = camera.intrinsics.projection;
    Eigen::VectorXd longer(p.size() + static_cast<Eigen::Index>(leading.size()));
    longer << Eigen::Map<const Eigen::VectorXd>(leading.begin(),
                                                static_cast<Eigen::Index>(leading.size())),
        p;
    p = longer;
    camera.intrinsics.projection_model = model;
    camera.intrinsics.distortion_model = DistortionModel::kNone;
    camera.intrinsics.distortion.resize(0);
    models.cameras.push_back(camera);
  };
  add(ProjectionModel::kOmni, {1.2});
  add(ProjectionModel::kEucm, {0.6, 1.1});
  add(ProjectionModel::kDs, {-0.2, 0.6});
  all.push_back(models);
  return all;
}

std::string oursText(const Calibration& calibration) {
  Json json{{"schema", 1}};
  json.update(toJson(calibration));
  return json.dump(1);
}

std::string exported(const Calibration& calibration, ExportTool tool, const std::string& ending) {
  ExportOptions options;
  options.source = "rig.json";
  for (const ExportFile& file : exportCalibration(calibration, tool, options).files) {
    if (file.name.ends_with(ending)) return file.text;
  }
  throw std::logic_error("no file " + ending);
}

void readAnyCalibration(const std::string& path) {
  expectStable(path, readCalibration(path), oursText, readCalibration);
  const CalibrationFile file(path);
  file.statesImuNoise(), file.extras(), file.deviations();
}

/// Kalibr's camchain says nothing of gravity, noise, deviations.
void readCamchain(const std::string& path) {
  const KalibrCamchain chain = readKalibrCamchain(path);
  for (std::size_t i = 1; i < chain.cameras.size(); ++i) chainContradiction(chain, i);
  const Calibration calibration = calibrationOf(chain);
  expectStable(path, calibration, oursText, readCalibration);
  expectStable(
      path, calibration, [](const Calibration& c) { return kalibrCamchainText(c); },
      readCalibration);
}

/// A camera that looks at the target's middle from several sides; x, y, z, w of the conjugate.
std::string kalibrPoses() {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d p(0.3 + 0.4 * std::sin(i), 0.3 + 0.3 * std::cos(1.7 * i), 0.8);
    const Eigen::Vector3d z = (Eigen::Vector3d(0.3, 0.3, 0) - p).normalized();
    const Eigen::Vector3d x = -Eigen::Vector3d(1, 0.02 * i, 0).cross(z).cross(z).normalized();
    Eigen::Matrix3d R;
    R << x, z.cross(x), z;
    const Eigen::Quaterniond q(R);
    text += std::to_string(1404733405832800000 + i * 50'000'000LL);
    for (const double v : {p.x(), p.y(), p.z(), -q.x(), -q.y(), -q.z(), q.w()}) {
      text += "," + std::to_string(v);
    }
    text += "\n";
  }
  return text;
}

}  // namespace

Parser camchain() {
  const auto seeds = [] {
    std::vector<std::string> seeds;
    for (const Calibration& calibration : calibrations()) {
      seeds.push_back(kalibrCamchainText(calibration));
    }
    seeds.push_back(exported(calibrations().front(), ExportTool::kOpenVins, "imucam_chain.yaml"));
    return seeds;
  };
  return {readCamchain, seeds, {"line_delay", "fov", "radial-tangential", "equi"}};
}

Parser kalibr_results() {
  const auto read = [](const std::string& path) {
    kalibrFileKind(path);
    for (const KalibrTextCamera& camera : readKalibrResults(path).cameras) camera.rmsPx();
  };
  return {read, [] { return std::vector<std::string>{kCamText, kImuText}; }, {"+-", "IMU1:"}};
}

Parser kalibr_poses() {
  const auto read = [](const std::string& path) {
    kalibrFileKind(path);
    readKalibrPoses(path);
  };
  return {read, [] { return std::vector<std::string>{kalibrPoses()}; }, {}};
}

Parser yac() {
  return {readAnyCalibration,
          [] { return std::vector<std::string>{test::kYacResult}; },
          {"fov", "none", "ds", "radtan8"}};
}

Parser basalt() {
  const auto seeds = [] {
    std::vector<std::string> seeds;
    for (const std::string& rig : simulatedRigNames()) {
      const Calibration calibration = simulatedRig(rig).calibration;
      seeds.push_back(exported(calibration, ExportTool::kBasalt, "_calib.json"));
    }
    return seeds;
  };
  return {
      readAnyCalibration, seeds, {"pinhole", "ds", "eucm", "ucm", "kb4", "xi", "alpha", "beta"}};
}

Parser ours() {
  const auto seeds = [] {
    std::vector<std::string> seeds;
    for (const Calibration& calibration : calibrations()) seeds.push_back(oursText(calibration));
    return seeds;
  };
  return {readAnyCalibration,
          seeds,
          {"covariance", "parameters", "matrix", "unit", "provenance", "input", "input_hash",
           "camera_time_offsets_s", "intrinsics_std", "T_C0Ci_std", "cam0.fu"}};
}

}  // namespace plumbline::fuzz
