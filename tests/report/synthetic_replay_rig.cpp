// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "calibrator/base/image.h"
#include "datasets/images/image_io.h"
#include "tests/report/synthetic_replay_parts.h"

namespace plumbline::test {
namespace {

constexpr int kWidth = 752, kHeight = 480;

Eigen::Vector2d projected(const CameraCalibration& camera, const Eigen::Vector3d& p_C) {
  const Eigen::VectorXd& k = camera.intrinsics.projection;
  return {k[0] * p_C.x() / p_C.z() + k[2], k[1] * p_C.y() / p_C.z() + k[3]};
}

/// Sets the pixels whose centres lie in the convex quadrilateral.
void fill(GrayImage& image, const Eigen::Vector2d (&quad)[4], std::uint8_t value) {
  int low[2] = {image.width(), image.height()}, high[2] = {-1, -1};
  for (const Eigen::Vector2d& p : quad) {
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], static_cast<int>(std::floor(p[i])));
      high[i] = std::max(high[i], static_cast<int>(std::ceil(p[i])));
    }
  }
  for (int y = std::max(0, low[1]); y <= std::min(high[1], image.height() - 1); ++y) {
    for (int x = std::max(0, low[0]); x <= std::min(high[0], image.width() - 1); ++x) {
      int left = 0;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d side = quad[(k + 1) % 4] - quad[k];
        left += side.x() * (y - quad[k].y()) - side.y() * (x - quad[k].x()) > 0 ? 1 : 0;
      }
      if (left == 0 || left == 4) image.at(x, y) = value;
    }
  }
}

GrayImage picture(const std::vector<Corner>& corners, int seed) {
  GrayImage image(kWidth / 2, kHeight / 2, 190);
  std::minstd_rand noise(static_cast<unsigned>(seed) + 1);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image.at(x, y) = static_cast<std::uint8_t>(150 + x / 5 + noise() % 24);
    }
  }
  for (std::size_t i = 0; i + 3 < corners.size(); ++i) {
    if (corners[i].id % 4 != 0 || corners[i + 3].id != corners[i].id + 3) continue;
    Eigen::Vector2d quad[4];
    for (std::size_t k = 0; k < 4; ++k) quad[k] = 0.5 * corners[i + k].uv;
    fill(image, quad, 40);
  }
  return image;
}

}  // namespace

std::vector<CameraCalibration> syntheticStereo() {
  std::vector<CameraCalibration> cameras(2);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    cameras[i].name = "cam" + std::to_string(i);
    Intrinsics& k = cameras[i].intrinsics;
    k.resolution = {kWidth, kHeight};
    k.projection = Eigen::Vector4d(458, 457, 375.5 + 4 * static_cast<double>(i), 239.5);
    k.distortion = Eigen::Vector4d::Zero();
  }
  cameras[1].T_C0Ci.t = {0.11, 0, 0};
  return cameras;
}

Transform SyntheticRig::lookAt(const Eigen::Vector3d& from, double roll) const {
  const Eigen::Vector3d centre(0.5 * target_.width(), 0.5 * target_.height(), 0);
  const Eigen::Vector3d forward = (centre - from).normalized();
  Eigen::Matrix3d R;
  R.col(0) = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  R.col(1) = forward.cross(R.col(0));
  R.col(2) = forward;
  return {Eigen::Matrix3d(Eigen::AngleAxisd(roll, forward) * R), from};
}

Transform SyntheticRig::wander(int f, int n) const {
  const double s = 40.0 * f / n;
  return lookAt({0.3 + 0.55 * std::sin(0.71 * s), 0.3 + 0.4 * std::sin(0.53 * s + 1),
                 0.85 + 0.3 * std::cos(0.37 * s)},
                0.35 * std::sin(0.9 * s));
}

std::vector<std::vector<Corner>> SyntheticRig::seenFrom(const Transform& T_FC0) const {
  std::vector<std::vector<Corner>> all;
  for (const CameraCalibration& camera : cameras_) {
    const Transform T_CF = (T_FC0 * camera.T_C0Ci).inverse();
    std::vector<Corner> seen;
    for (int id = 0; id < target_.cornerCount(); ++id) {
      const Eigen::Vector2d p = target_.corner(id);
      const Eigen::Vector2d uv = projected(camera, T_CF * Eigen::Vector3d(p.x(), p.y(), 0));
      const bool inside = uv.x() > 0 && uv.x() < kWidth - 1 && uv.y() > 0 && uv.y() < kHeight - 1;
      if (inside) seen.push_back({id, uv});
    }
    all.push_back(std::move(seen));
  }
  return all;
}

CandidateRound SyntheticRig::views(int f, double best_nats) const {
  CandidateRound round;
  for (int k = 0; k < 100; ++k) {
    const int column = k % 10, row = k / 10;
    const double x = (column - 4.5) / 4.5, y = (row - 4.5) / 4.5;
    round.names.push_back("cam" + std::to_string(k % 2) + " x " + std::to_string(column) + " y " +
                          std::to_string(row));
    round.T_FC0.push_back(lookAt({0.3 + 0.8 * x, 0.3 + 0.6 * y, 0.9 - 0.2 * (x * x + y * y)}, 0));
    round.mi_nats.push_back(best_nats * 0.95 * (0.2 + 0.8 * std::abs(std::sin(0.37 * k + f))));
    if (k % 17 == 16) round.mi_nats.back() = std::numeric_limits<double>::quiet_NaN();
  }
  round.best = (11 * f) % 97;
  if (std::isnan(round.mi_nats[static_cast<std::size_t>(round.best)])) ++round.best;
  round.mi_nats[static_cast<std::size_t>(round.best)] = best_nats;
  return round;
}

CandidateRound SyntheticRig::trajectories(int f, double best_nats) const {
  CandidateRound round;
  round.names = {"figure 8 horizontal", "figure 8 vertical", "pan horizontal",
                 "pan vertical",        "diagonal 0",        "diagonal 1"};
  for (int k = 0; k < 6; ++k) {
    round.T_FC0.push_back(lookAt({0.3, 0.3, 0.8 + 0.02 * k}, 0));
    round.mi_nats.push_back(best_nats * (0.3 + 0.1 * k));
  }
  round.mi_nats[3] = std::numeric_limits<double>::quiet_NaN();
  round.best = f % 3;
  round.mi_nats[static_cast<std::size_t>(round.best)] = best_nats;
  return round;
}

Suggestion SyntheticRig::suggest(int id, const Decision& d, const CandidateRound& round) const {
  const auto best = static_cast<std::size_t>(round.best);
  Suggestion s;
  s.id = id;
  s.stage = d.stage;
  s.t = d.t;
  s.candidate = round.names[best];
  s.camera = d.stage == GuideStage::kCamera ? round.best % 2 : 0;
  s.T_FC0 = round.T_FC0[best];
  s.mi_nats = round.mi_nats[best];
  for (int i = 0; d.stage == GuideStage::kCameraImu && i <= 300; ++i) {
    const double a = 2 * 3.14159265 * i / 300;
    s.path.push_back(lookAt({0.3 + 0.3 * std::sin(a), 0.3 + 0.25 * std::sin(2 * a), 0.8}, 0));
  }
  return s;
}

std::vector<std::string> pictures(const std::vector<std::vector<Corner>>& corners, int frame) {
  std::vector<std::string> jpegs;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    jpegs.push_back(encodeJpeg(picture(corners[i], 2 * frame + static_cast<int>(i)), 60));
  }
  return jpegs;
}

}  // namespace plumbline::test
