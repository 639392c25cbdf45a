// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/transform.h"
#include "report/html/scene.h"

namespace plumbline::html_internal {
namespace {

// Metres, with the four digits that an eye or a frustum needs; points and poses below go to a tenth
// of a millimetre, finer than any view shows.
std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{:.4g},{:.4g},{:.4g}]", v.x(), v.y(), v.z());
}

std::string join(const auto& items, const auto& write) {
  std::string text = "[";
  for (const auto& item : items) {
    if (text.size() > 1) text += ',';
    text += write(item);
  }
  return text + ']';
}

std::string cells(const std::vector<std::vector<int>>& all) {
  return join(all, [](const std::vector<int>& cell) {
    return join(cell, [](int i) { return std::to_string(i); });
  });
}

std::string objectJson(const SceneObject& o) {
  std::string json =
      fmt::format("{{\"layer\":\"{}\",\"colour\":[{},{},{}],\"width\":{:g},\"points\":{}", o.layer,
                  o.colour.red, o.colour.green, o.colour.blue, o.width,
                  join(o.points, [](const Eigen::Vector3d& p) {
                    return fmt::format("{:.4f},{:.4f},{:.4f}", p.x(), p.y(), p.z());
                  }));
  if (!o.frames.empty()) {
    json += ",\"frames\":" + join(o.frames, [](int i) { return std::to_string(i); });
  }
  if (!o.lines.empty()) json += ",\"lines\":" + cells(o.lines);
  if (!o.polygons.empty()) json += ",\"polygons\":" + cells(o.polygons);
  if (!o.colours.empty()) {
    json += ",\"colours\":{";
    bool first = true;
    for (const auto& [name, colours] : o.colours) {
      json += fmt::format("{}\"{}\":{}", first ? "" : ",", name, join(colours, [](const Colour& c) {
                            return fmt::format("{},{},{}", c.red, c.green, c.blue);
                          }));
      first = false;
    }
    json += '}';
  }
  return json + '}';
}

std::string cameraJson(const SceneCamera& c) {
  return fmt::format("{{\"name\":{},\"points\":{}}}", nlohmann::json(c.name).dump(),
                     join(c.frustum_C0, [](const Eigen::Vector3d& p) { return list(p); }));
}

/// Seconds, place, and the rotation vector, which scene_viewer.js turns back by Rodrigues' formula.
std::string poseJson(const ScenePose& p) {
  const Eigen::Vector3d w = logSO3(p.T_FC0.R);
  return fmt::format("[{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}]", p.seconds, p.T_FC0.t.x(),
                     p.T_FC0.t.y(), p.T_FC0.t.z(), w.x(), w.y(), w.z());
}

/// A pinhole picture of the scene; pixels of a 900 x 520 view.
struct StillCamera {
  // Rows as a camera's axes: x right, y down, z ahead.
  explicit StillCamera(const Scene& scene) : eye(scene.eye) {
    axes.row(2) = (scene.focus - scene.eye).normalized();
    axes.row(0) = axes.row(2).cross(scene.up.transpose()).normalized();
    axes.row(1) = axes.row(2).cross(axes.row(0));
  }
  Eigen::Vector3d project(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = axes * (p - eye);
    // What lies behind the eye would be mirrored.
    const double z = std::max(1e-3, q.z());
    // A focal length of 900 px, 53 degrees across, about the middle of the picture.
    return {450 + 900 * q.x() / z, 260 + 900 * q.y() / z, z};
  }
  Eigen::Vector3d eye;
  Eigen::Matrix3d axes;
};

std::string polyline(const StillCamera& camera, const SceneObject& o, const std::vector<int>& cell,
                     bool closed) {
  std::string d;
  for (const int i : cell) {
    const Eigen::Vector3d p = camera.project(o.points[static_cast<std::size_t>(i)]);
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", p.x(), p.y());
  }
  return closed ? d + 'z' : d;
}

std::string hex(const Colour& c) {
  return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue);
}

/// Painted in the scene's order, whatever is nearer: the target lies below all else.
std::string objectSvg(const StillCamera& camera, const SceneObject& o) {
  std::string svg, d;
  for (const auto& polygon : o.polygons) d += polyline(camera, o, polygon, true);
  if (!d.empty()) svg += fmt::format("<path d=\"{}\" fill=\"{}\"/>", d, hex(o.colour));
  // The still picture has the colours that the viewer begins with ("colour" in toJson()).
  const auto by = o.colours.find("rmse");
  std::string run;  // lines of one colour in a row become one path
  Colour current = o.colour;
  const auto flush = [&] {
    if (run.empty()) return;
    svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"/>", run,
                       hex(current), o.width);
    run.clear();
  };
  for (const auto& line : o.lines) {
    const Colour colour = by == o.colours.end() || line.empty()
                              ? o.colour
                              : by->second[static_cast<std::size_t>(line[0])];
    if (!(colour == current)) flush();
    current = colour;
    run += polyline(camera, o, line, false);
  }
  flush();
  return svg;
}

}  // namespace

std::string toJson(const Scene& scene) {
  return fmt::format(
      "{{\"focus\":{},\"eye\":{},\"up\":{},\"colour\":\"rmse\",\"cameras\":{},\"poses\":{},"
      "\"objects\":{}}}",
      list(scene.focus), list(scene.eye), list(scene.up), join(scene.cameras, cameraJson),
      join(scene.poses, poseJson), join(scene.objects, objectJson));
}

std::string toStillSvg(const Scene& scene, const std::string& id) {
  const StillCamera camera(scene);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"{}\" class=\"scene-still\" "
      "viewBox=\"0 0 900 520\" role=\"img\" aria-label=\"Target and camera poses, still picture\">",
      id);
  for (const SceneObject& object : scene.objects) svg += objectSvg(camera, object);
  return svg + "</svg>";
}

}  // namespace plumbline::html_internal
