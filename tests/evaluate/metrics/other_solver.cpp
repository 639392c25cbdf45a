// SPDX-License-Identifier: BSD-3-Clause
#include "tests/evaluate/metrics/other_solver.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace plumbline::test {
namespace {

std::ifstream opened(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " is missing: set PLUMBLINE_SHARED_DATA");
  return file;
}

std::string folderOf(const std::string& shared_data) {
  return shared_data + "/euroc_cam_april_images/other_solver/";
}

Intrinsics intrinsicsOf(const nlohmann::json& json, const std::string& model) {
  const auto at = [&](const char* key) { return json.at(key).get<double>(); };
  Intrinsics k;
  k.resolution = {json.at("width").get<int>(), json.at("height").get<int>()};
  k.distortion_model = DistortionModel::kNone;
  const Eigen::Vector4d lens(at("fx"), at("fy"), at("cx"), at("cy"));
  k.projection = lens;
  if (model == "kb4") {
    k.distortion_model = DistortionModel::kEquidistant;
    k.distortion = Eigen::Vector4d(at("p1"), at("p2"), at("p3"), at("p4"));
  } else if (model != "pinhole") {
    k.projection_model = model == "ds" ? ProjectionModel::kDs : ProjectionModel::kEucm;
    k.projection.resize(6);
    k.projection << at("p1"), at("p2"), lens;
  }
  return k;
}

Transform transformOf(const nlohmann::json& json) {
  const auto at = [&](const char* key) { return json.at(key).get<double>(); };
  return {Eigen::Quaterniond(at("qw"), at("qx"), at("qy"), at("qz")),
          Eigen::Vector3d(at("px"), at("py"), at("pz"))};
}

}  // namespace

Session otherSolversSession(const std::string& shared_data) {
  std::ifstream file = opened(folderOf(shared_data) + "detected_corners.csv");
  std::map<int, ImageView> views[2];
  std::string line;
  std::getline(file, line);  // header
  while (std::getline(file, line)) {
    int frame = 0, camera = 0, tag = 0, corner = 0;
    double u = 0, v = 0;
    if (std::sscanf(line.c_str(), "%d,%d,%d,%d,%lf,%lf", &frame, &camera, &tag, &corner, &u, &v) !=
        6) {
      throw std::runtime_error("not a corner: " + line);
    }
    views[camera][frame].corners.push_back({4 * tag + corner, {u, v}});
  }
  Session session;
  session.name = "euroc_cam_april_images";
  for (int c = 0; c < 2; ++c) {
    CameraStream& stream = session.cameras.emplace_back();
    stream.name = "cam" + std::to_string(c);
    stream.resolution = {752, 480};
    for (auto& [frame, view] : views[c]) {
      view.t = 1'000'000'000 + frame * 50'000'000LL;
      std::sort(view.corners.begin(), view.corners.end(),
                [](const Corner& a, const Corner& b) { return a.id < b.id; });
      stream.views.push_back(view);
    }
  }
  return session;
}

std::vector<CameraCalibration> otherSolversCameras(const std::string& shared_data,
                                                   const std::string& model) {
  std::ifstream file = opened(folderOf(shared_data) + "gt_calib_" + model + ".json");
  const auto json = nlohmann::json::parse(file).at("value0");
  std::vector<CameraCalibration> cameras;
  for (std::size_t c = 0; c < 2; ++c) {
    CameraCalibration& camera = cameras.emplace_back();
    camera.name = "cam" + std::to_string(c);
    camera.intrinsics = intrinsicsOf(json.at("cam.intrinsics").at(c), model);
    camera.T_C0Ci = transformOf(json.at("cam.T_i_c").at(c));
  }
  return cameras;
}

}  // namespace plumbline::test
