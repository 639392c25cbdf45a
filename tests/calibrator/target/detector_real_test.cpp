// SPDX-License-Identifier: BSD-3-Clause
// The detector on photographs: 26 stereo pairs of EuRoC's rig and two single images, beside the
// corners and the camera model that an independent solver found on the pairs.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/target/detector.h"
#include "datasets/images/image_io.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

std::string dataPath(const std::string& below) {
  return std::string(PLUMBLINE_SHARED_DATA) + "/" + below;
}

/// The independent solver's Kannala-Brandt cameras (other_solver/gt_calib_kb4.json). The
/// calibration published with EuRoC (radtan) will not do here: it is off by several pixels at the
/// image's edge.
struct KannalaBrandt {
  double fx, fy, cx, cy, k1, k2, k3, k4;

  Vector2d project(const Vector2d& n) const {
    const double r = n.norm();
    const double scale = r > 1e-9 ? bent(std::atan(r)) / r : 1;
    return {fx * scale * n.x() + cx, fy * scale * n.y() + cy};
  }
  Vector2d unproject(const Vector2d& uv) const {
    const Vector2d d((uv.x() - cx) / fx, (uv.y() - cy) / fy);
    double angle = d.norm();
    for (int i = 0; i < 30; ++i) angle += d.norm() - bent(angle);
    return d.norm() > 1e-9 ? Vector2d(d * std::tan(angle) / d.norm()) : d;
  }
  double bent(double a) const {
    const double s = a * a;
    return a * (1 + s * (k1 + s * (k2 + s * (k3 + s * k4))));
  }
};

constexpr KannalaBrandt kCameras[] = {
    {461.1581901632605, 459.80802859479726, 365.89723869011729, 249.35492318319008,
     -0.004593052532206038, 0.02753243203703135, -0.036977671771001707, 0.018610217245570674},
    {459.7448068651981, 458.3535053463389, 379.3639614954641, 256.0435254270625,
     0.00454958861267974, 0.002485490491605887, -0.01060134878472518, 0.010781041140891151}};

struct Photograph {
  int camera, frame;
  Detection detection;
};

std::vector<Photograph> detectAll() {
  const AprilGridDetector detector(AprilGrid{});
  std::vector<Photograph> all;
  for (int camera = 0; camera < 2; ++camera) {
    for (int frame = 0; frame <= 50; ++frame) {
      const long long stamp = 1000000000LL + 50000000LL * frame;
      const std::string path = dataPath("euroc_cam_april_images/cam" + std::to_string(camera) +
                                        "/data/" + std::to_string(stamp) + ".jpg");
      if (!std::filesystem::exists(path)) continue;
      all.push_back({camera, frame, detector.detect(readGrayImage(path).view())});
    }
  }
  return all;
}

/// The photographs are detected once for all tests.
const std::vector<Photograph>& photographs() {
  static const std::vector<Photograph> all = detectAll();
  return all;
}

void requireData() {
  ASSERT_TRUE(std::filesystem::exists(dataPath("euroc_cam_april_images")))
      << "no photographs: configure with -DPLUMBLINE_SHARED_DATA=<folder of the recordings>";
}

/// Homography from the grid to normalised coordinates by the corners of all tags but one.
Eigen::Matrix3d fitWithout(const AprilGrid& grid, const Photograph& photograph, int left_out) {
  std::vector<Corner> used;
  std::copy_if(photograph.detection.corners.begin(), photograph.detection.corners.end(),
               std::back_inserter(used),
               [&](const Corner& corner) { return corner.id / 4 != left_out; });
  Eigen::MatrixXd A(2 * used.size(), 8);
  Eigen::VectorXd b(2 * used.size());
  Eigen::VectorXd h = Eigen::VectorXd::Zero(8);
  for (int round = 0; round < 4; ++round) {  // reweighted by the denominator: geometric error
    for (std::size_t i = 0; i < used.size(); ++i) {
      const Vector2d p = grid.corner(used[i].id);
      const Vector2d n = kCameras[photograph.camera].unproject(used[i].uv);
      const double w = 1 / (1 + h[6] * p.x() + h[7] * p.y());
      const auto row = static_cast<Eigen::Index>(2 * i);
      A.row(row) << w * p.x(), w * p.y(), w, 0, 0, 0, -w * p.x() * n.x(), -w * p.y() * n.x();
      A.row(row + 1) << 0, 0, 0, w * p.x(), w * p.y(), w, -w * p.x() * n.y(), -w * p.y() * n.y();
      b.segment<2>(row) = w * n;
    }
    h = A.colPivHouseholderQr().solve(b);
  }
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return H;
}

/// Largest error of a tag's corners against the camera model fitted to the other tags [px].
double errorAgainstOthers(const AprilGrid& grid, const Photograph& photograph, int tag) {
  const Eigen::Matrix3d H = fitWithout(grid, photograph, tag);
  double worst = 0;
  for (const Corner& corner : photograph.detection.corners) {
    if (corner.id / 4 != tag) continue;
    const Vector2d p = grid.corner(corner.id);
    const Eigen::Vector3d n = H * Eigen::Vector3d(p.x(), p.y(), 1);
    const Vector2d expected = kCameras[photograph.camera].project(n.head<2>() / n.z());
    worst = std::max(worst, (corner.uv - expected).norm());
  }
  return worst;
}

TEST(DetectorReal, FindsAtLeast1571TagsThatFitTheOthersToAPixel) {
  requireData();
  const AprilGrid grid;
  ASSERT_EQ(photographs().size(), 52u);
  int good = 0;
  for (const Photograph& photograph : photographs()) {
    for (const DetectedTag& tag : photograph.detection.tags) {
      EXPECT_LE(tag.hamming, 2);
      const double error = errorAgainstOthers(grid, photograph, tag.id);
      EXPECT_LE(error, 1.0) << "camera " << photograph.camera << ", frame " << photograph.frame
                            << ", tag " << tag.id;
      if (tag.hamming <= 2 && error <= 1.0) ++good;
    }
  }
  RecordProperty("tags", good);
  EXPECT_GE(good, 1571);
}

TEST(DetectorReal, CornersAreThoseOfTheOtherSolver) {
  requireData();
  std::ifstream file(dataPath("euroc_cam_april_images/other_solver/detected_corners.csv"));
  ASSERT_TRUE(file.good());
  std::map<std::tuple<int, int, int>, Vector2d> others;  // camera, frame, corner id
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    int frame = 0, camera = 0, tag = 0, corner = 0;
    Vector2d uv;
    fields >> frame >> camera >> tag >> corner >> uv.x() >> uv.y();
    others[{camera, frame, 4 * tag + corner}] = uv;
  }
  std::vector<double> distances;
  for (const Photograph& photograph : photographs()) {
    for (const Corner& corner : photograph.detection.corners) {
      const auto other = others.find({photograph.camera, photograph.frame, corner.id});
      if (other != others.end()) distances.push_back((corner.uv - other->second).norm());
    }
  }
  ASSERT_GE(distances.size(), 6200u);  // of 6251
  std::sort(distances.begin(), distances.end());
  EXPECT_LE(distances[distances.size() / 2], 0.1);  // asked for: 0.3
  EXPECT_LE(distances[distances.size() * 99 / 100], 0.5);
}

TEST(DetectorReal, ShowsTheSpacingOfTheTarget) {
  requireData();
  for (const Photograph& photograph : photographs()) {
    ASSERT_TRUE(photograph.detection.spacing.has_value());
    EXPECT_NEAR(*photograph.detection.spacing, 0.3, 0.01);
  }
}

TEST(DetectorReal, FindsEveryTagOfTheSingleImagesFisheyeIncluded) {
  for (const char* name : {"EuRoC.png", "TUM_VI.png"}) {
    const GrayImage image = readGrayImage(dataPath("aprilgrid_single_images/") + name);
    const Detection detection = AprilGridDetector(AprilGrid{}).detect(image.view());
    EXPECT_EQ(detection.tags.size(), 36u) << name;
    EXPECT_EQ(detection.corners.size(), 144u) << name;
    EXPECT_EQ(detection.rejected_tags, 0) << name;
  }
}

}  // namespace
}  // namespace plumbline
