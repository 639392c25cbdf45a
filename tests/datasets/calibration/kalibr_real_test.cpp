// SPDX-License-Identifier: BSD-3-Clause
// Every result of Kalibr and of yac in PLUMBLINE_SHARED_DATA.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using Kind = KalibrFileKind;

std::string shared(const std::string& name) {
  const fs::path path = fs::path(PLUMBLINE_SHARED_DATA) / name;
  EXPECT_TRUE(fs::exists(path)) << path << " is missing; configure with -DPLUMBLINE_SHARED_DATA="
                                << "<folder of the real recordings>";
  return path.string();
}

std::vector<std::string> filesBelow(const std::string& name) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(shared(name))) {
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  }
  return files;
}

void readWhole(const std::string& path, Kind kind) {
  switch (kind) {
    case Kind::kCamchain:
    case Kind::kCamchainImu:
      (void)calibrationOf(readKalibrCamchain(path));
      break;
    case Kind::kImu:
      (void)readKalibrImus(path);
      break;
    case Kind::kResultsCameras:
    case Kind::kResultsImu:
      (void)readKalibrResults(path);
      break;
    case Kind::kPoses:
      (void)readKalibrPoses(path);
      break;
  }
}

// The kind by which Kalibr names its files, for the test alone.
bool isNamedAsOutput(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  const bool results = name.find("results-") != std::string::npos;
  return results || name.find("camchain") != std::string::npos ||
         name.find("poses-") != std::string::npos || name.rfind("imu", 0) == 0 ||
         name.find("-imu.yaml") != std::string::npos;
}

TEST(RealKalibr, EveryOutputIsRecognisedAndReads) {
  std::map<Kind, int> counts;
  for (const char* const folder : {"kalibr_results", "euroc_imu_april/kalibr_runs"}) {
    for (const std::string& path : filesBelow(folder)) {
      const auto kind = kalibrFileKind(path);
      EXPECT_EQ(kind.has_value(), isNamedAsOutput(path)) << path;
      if (!kind) continue;
      ++counts[*kind];
      EXPECT_NO_THROW(readWhole(path, *kind)) << path;
    }
  }
  EXPECT_EQ(counts[Kind::kCamchain], 37);
  EXPECT_EQ(counts[Kind::kCamchainImu], 21);
  EXPECT_EQ(counts[Kind::kResultsCameras], 35);
  EXPECT_EQ(counts[Kind::kResultsImu], 21);
  EXPECT_EQ(counts[Kind::kPoses], 1);
  EXPECT_EQ(counts[Kind::kImu], 33);
}

TEST(RealKalibr, EveryTextBelongsToTheCamchainBesideIt) {
  int texts = 0;
  for (const std::string& path : filesBelow("kalibr_results")) {
    const auto kind = kalibrFileKind(path);
    if (kind != Kind::kCamchain && kind != Kind::kCamchainImu) continue;
    const KalibrRun run = readKalibrRun(path);
    const auto& text = kind == Kind::kCamchain ? run.results_cameras : run.results_imu;
    texts += text ? 1 : 0;
    EXPECT_TRUE(run.remarks.empty()) << path << ": " << run.remarks.front();
  }
  EXPECT_EQ(texts, 53);
}

TEST(RealKalibr, EurocRunHasItsPublishedFigures) {
  const KalibrRun run = readKalibrRun(shared("euroc_imu_april/kalibr_runs/camera_imu"));
  const Calibration calibration = run.calibration();
  EXPECT_TRUE(hasOwnOffset(calibration.imu->time_offsets, 1));
  EXPECT_NEAR(meanTimeOffset(*calibration.imu), 6.344559e-6, 1e-12);
  EXPECT_EQ(calibration.imu->noise.gyro_density, 1.6968e-4);
  EXPECT_NEAR(calibration.imu->gravity_m_s2, 9.80655, 1e-3);
  const KalibrResults text = *run.results();
  EXPECT_NEAR(*text.cameras[0].rmsPx(), std::hypot(0.44678591646535465, 0.2778697782162579), 1e-15);
  EXPECT_NEAR(text.gyro_rad_s->rms(), std::hypot(0.002631700304380293, 0.0014549124240665098),
              1e-15);
}

TEST(RealKalibr, AModelWithScaleIsReadForComparing) {
  const std::string path = shared(
      "kalibr_results/dasol_d435i_919122071416/before_internal_imu_calib/kalibr/"
      "d435i_919122071416/volume/dynamic/result");
  const KalibrRun run = readKalibrRun(path);
  EXPECT_EQ(run.imu->imus[0].model, "scale-misalignment");
  EXPECT_NEAR((*run.imu->imus[0].accel_M)(2, 2), 0.98045, 1e-5);
}

// ---- the quaternion trap

struct Trap {
  Session session;
  Calibration calibration;
  Trajectory poses;
};

Trap trap() {
  const std::string folder = shared("euroc_imu_april/kalibr_runs/camera_every_2nd_frame");
  const KalibrRun run = readKalibrRun(folder);
  return {readSession(shared("euroc_imu_april")), run.calibration(), *run.poses};
}

// RMS of the reprojection of camera 0's corners [px]; corners that do not project count as 1000 px.
double reprojectionRms(const Trap& t, const Trajectory& poses) {
  double sum = 0;
  int count = 0;
  const auto& views = t.session.cameras[0].views;
  for (const StampedPose& pose : poses.poses) {
    const auto view = std::lower_bound(views.begin(), views.end(), pose.t,
                                       [](const ImageView& v, TimeNs at) { return v.t < at; });
    if (view == views.end() || view->t != pose.t) continue;
    for (const Corner& corner : view->corners) {
      const Eigen::Vector2d xy = t.session.target.corner(corner.id);
      const Eigen::Vector3d p_F(xy.x(), xy.y(), 0);
      const auto uv =
          project(t.calibration.cameras[0].intrinsics, pose.transform().inverse() * p_F);
      sum += uv ? std::min(1e6, (*uv - corner.uv).squaredNorm()) : 1e6;
      ++count;
    }
  }
  EXPECT_GT(count, 1000);
  return std::sqrt(sum / count);
}

Trajectory mapped(Trajectory poses, const std::function<Eigen::Quaterniond(Eigen::Vector4d)>& f) {
  for (StampedPose& pose : poses.poses) {
    const Eigen::Quaterniond& q = pose.q;  // back to the four columns of the file
    pose.q = f({-q.x(), -q.y(), -q.z(), q.w()});
  }
  return poses;
}

TEST(RealKalibr, PosesReprojectTheCornersUnderOneConventionOnly) {
  const Trap t = trap();
  ASSERT_EQ(t.poses.poses.size(), 105U);
  const double rms = reprojectionRms(t, t.poses);
  EXPECT_LT(rms, 0.75) << "all corners, also those that Kalibr took for outliers";
  using Q = Eigen::Quaterniond;
  const auto as_header = [](Eigen::Vector4d v) { return Q(v[0], v[1], v[2], v[3]); };
  const auto header_conjugate = [](Eigen::Vector4d v) { return Q(v[0], -v[1], -v[2], -v[3]); };
  const auto not_conjugate = [](Eigen::Vector4d v) { return Q(v[3], v[0], v[1], v[2]); };
  EXPECT_GT(reprojectionRms(t, mapped(t.poses, as_header)), 50);
  EXPECT_GT(reprojectionRms(t, mapped(t.poses, header_conjugate)), 50);
  EXPECT_GT(reprojectionRms(t, mapped(t.poses, not_conjugate)), 50);
}

// ---- yac

TEST(RealYac, ResultsAgreeWithThePublishedCalibration) {
  const Calibration yac = readCalibration(shared("yac_results/camera_imu.yaml"));
  const Calibration kalibr =
      readCalibration(shared("euroc_imu_april/kalibr_runs/camera_imu/euroc-camchain-imucam.yaml"));
  ASSERT_EQ(yac.cameras.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector6d d = boxminus(yac.cameras[i].T_C0Ci, kalibr.cameras[i].T_C0Ci);
    EXPECT_LT(d.head<3>().norm(), 1e-4) << i;
    EXPECT_LT(d.tail<3>().norm(), 1e-6) << i;
  }
  const Vector6d d = boxminus(yac.imu->T_SC0, kalibr.imu->T_SC0);
  EXPECT_LT(d.head<3>().norm(), 1e-3);
  EXPECT_LT(d.tail<3>().norm(), 1e-3);
  EXPECT_EQ(yac.imu->noise.gyro_density, 1.6968e-4);
  const Calibration cameras = readCalibration(shared("yac_results/camera_every_12th_frame.yaml"));
  EXPECT_FALSE(cameras.imu);
  EXPECT_NEAR(cameras.cameras[1].T_C0Ci.t.x(), 0.10983, 1e-5);
}

}  // namespace
}  // namespace plumbline
