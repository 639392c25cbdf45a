// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "generated/report/embedded.h"
#include "report/html/calibration/sections.h"
#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

using Json = nlohmann::json;

// About a megabyte of base64, whatever the length of the recording.
constexpr std::size_t kMostCorners = 1e5;  // that a page carries; 8 bytes each
constexpr double kQuarter = 4;             // steps per pixel of a corner; 8191 px and more are one
constexpr double kMilli = 1000;            // and of an error; 32 px and more are one

/// Which views bring their corners: all if they are few, else the worst hundred and those of every
/// n-th frame, of all cameras. Frames of one view each may alternate between the cameras, so that
/// they are taken as many at a time as there are cameras.
std::vector<bool> carried(const std::vector<ViewErrors>& views,
                          const std::vector<std::size_t>& order) {
  constexpr std::size_t worst = 100;
  std::size_t all = 0;
  for (const ViewErrors& view : views) all += view.corners.size();
  // 0 where no view has a corner.
  const std::size_t step = (all + kMostCorners - 1) / kMostCorners;
  int cameras = 1;
  for (const ViewErrors& view : views) cameras = std::max(cameras, view.camera + 1);
  std::vector<bool> kept(views.size(), false);
  for (std::size_t i = 0; i < views.size(); ++i) {
    kept[i] = step <= 1 || static_cast<std::size_t>(views[i].frame / cameras) % step == 0;
  }
  for (std::size_t i = 0; i < std::min(worst, order.size()); ++i) kept[order[i]] = true;
  return kept;
}

/// By position of the view: the image as base64, and by how much it was made smaller.
Json imagesOf(const StageView& stage, const std::vector<ViewErrors>& views,
              const std::vector<ViewImage>& images) {
  Json all = Json::object();
  for (const ViewImage& image : images) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      // A record's image knows its frame by the stamp alone.
      const TimeNs t = stage.frames[static_cast<std::size_t>(views[i].frame)].t;
      if (views[i].camera != image.camera || t != image.t) continue;
      all[std::to_string(i)] = {{"factor", image.factor}, {"jpeg", base64(image.jpeg)}};
    }
  }
  return all;
}

/// Rows [camera, frame, RMSE, largest, used, first corner or -1, corners]; corners as u, v, e_u,
/// e_v, a rejected one with its u below zero less one step.
Json dataOf(const StageView& stage, const std::vector<ViewErrors>& views,
            const std::vector<bool>& kept, const std::vector<Transform>& T_FC0) {
  Json rows = Json::array();
  std::vector<std::int16_t> corners;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ViewErrors& v = views[i];
    const auto first = kept[i] ? static_cast<std::int64_t>(corners.size() / 4) : -1;
    // Rounded: what is not shown would only make the page larger. Written as null where no corner
    // was used.
    rows.push_back({v.camera, v.frame, std::round(1e4 * v.rmse_px) / 1e4,
                    std::round(1e3 * v.largest_px) / 1e3, v.used, first, v.corners.size()});
    if (!kept[i]) continue;
    for (const CornerResidual* r : v.corners) {
      // -1 - u, since 0 has no sign.
      // A corner may lie up to half a pixel left of the first centre: below 0 it would read as
      // rejected.
      const std::int16_t u = shortCell(kQuarter * std::max(r->uv.x(), 0.0F));
      corners.push_back(static_cast<std::int16_t>(r->used ? u : -1 - u));
      corners.push_back(shortCell(kQuarter * r->uv.y()));
      corners.push_back(shortCell(kMilli * r->error.x()));
      corners.push_back(shortCell(kMilli * r->error.y()));
    }
  }
  Json cameras = Json::array(), seconds = Json::array(), poses = Json::array();
  for (const CameraCalibration& c : stage.cameras) {
    const Resolution size = c.intrinsics.resolution;
    cameras.push_back({{"name", c.name}, {"width", size.width}, {"height", size.height}});
  }
  for (const double s : frameSeconds(stage)) seconds.push_back(std::round(1e3 * s) / 1e3);
  for (const Transform& T : T_FC0) {  // place [mm], and the angle between axis and target's normal
    // Of R(2, 2), the cosine, by its size: the axis points against the normal of the target.
    const double tilt = std::acos(std::clamp(std::abs(T.R(2, 2)), 0.0, 1.0));
    poses.push_back({std::lround(1e3 * T.t.x()), std::lround(1e3 * T.t.y()),
                     std::lround(1e3 * T.t.z()), std::round(readable("rad").factor * tilt)});
  }
  return {{"cameras", cameras},
          {"seconds", seconds},
          {"poses", poses},
          {"views", rows},
          {"corners", base64(corners)}};
}

/// The view's name, which leads to its picture.
Cell viewCell(const StageView& stage, const std::vector<ViewErrors>& views, std::size_t view) {
  const std::string& camera = stage.cameras[static_cast<std::size_t>(views[view].camera)].name;
  Cell cell = tight(fmt::format("{}, frame {}", camera, views[view].frame));
  cell.link = fmt::format("#{}-view-{}", stage.id, view);
  return cell;
}

Table worstTable(const StageView& stage, const std::vector<ViewErrors>& views,
                 const std::vector<std::size_t>& order) {
  Table table{{tight("View"), number("Time [s]"), number("RMSE [px]"), number("Largest error [px]"),
               number("Corners used"), number("Rejected")}};
  const std::vector<double> seconds = frameSeconds(stage);
  for (std::size_t i = 0; i < std::min(kWorstViews, order.size()); ++i) {
    const ViewErrors& v = views[order[i]];
    table.rows.push_back({viewCell(stage, views, order[i]),
                          number("{:.2f}", seconds[static_cast<std::size_t>(v.frame)]),
                          number(v.used > 0 ? fmt::format("{:.3f}", v.rmse_px) : kDash),
                          number(v.used > 0 ? fmt::format("{:.2f}", v.largest_px) : kDash),
                          number(v.used), number(v.corners.size() - v.used)});
  }
  return table;
}

constexpr std::size_t kMostRejected = 200;  // rows; the data under the plot have them all

/// A rejected corner, and the view that has it.
struct Rejected {
  std::size_t view = 0;
  const CornerResidual* corner = nullptr;
};

/// Those with the largest errors first.
std::vector<Rejected> rejectedOf(const std::vector<ViewErrors>& views) {
  std::vector<Rejected> list;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const CornerResidual* r : views[i].corners) {
      if (!r->used) list.push_back({i, r});
    }
  }
  std::ranges::stable_sort(list, std::greater(),
                           [](const Rejected& r) { return r.corner->error.squaredNorm(); });
  return list;
}

Block rejectedBlock(const StageView& stage, const std::vector<ViewErrors>& views,
                    const std::vector<Rejected>& list) {
  Table table{{tight("View"), number("Time [s]"), number("Corner"), number("u [px]"),
               number("v [px]"), number("Error u [px]"), number("Error v [px]"),
               number("Length [px]")}};
  const std::vector<double> seconds = frameSeconds(stage);
  for (std::size_t k = 0; k < std::min(kMostRejected, list.size()); ++k) {
    const CornerResidual& r = *list[k].corner;
    table.rows.push_back({viewCell(stage, views, list[k].view),
                          number("{:.2f}", seconds[static_cast<std::size_t>(r.frame)]),
                          number(r.corner_id), number("{:.1f}", r.uv.x()),
                          number("{:.1f}", r.uv.y()), number("{:+.2f}", r.error.x()),
                          number("{:+.2f}", r.error.y()), number("{:.2f}", r.error.norm())});
  }
  std::string text = fmt::format(
      "{} of {} corners took no part in the solution. Errors are measured minus projected.",
      list.size(), stage.residuals.size());
  if (list.size() > kMostRejected) text += fmt::format(" The {} largest:", kMostRejected);
  return {"Rejected corners", std::move(text), std::move(table)};
}

}  // namespace

Section viewsSection(const StageView& stage, const std::vector<Transform>& T_FC0,
                     const std::vector<ViewImage>& images) {
  Section section{"views", "Single views",
                  "Pick a view: click a moment in any plot over time, a camera in the scene, a row "
                  "of the worst views, or move the slider. Arrows are errors, measured minus "
                  "projected, magnified; rejected corners are crosses. Drag to zoom, double-click "
                  "to see all."};
  if (!images.empty()) section.lead += " The worst views have their images.";
  const std::vector<ViewErrors> views = viewErrors(stage.residuals);
  if (views.empty()) return section;
  const std::vector<std::size_t> order = worstFirst(views);
  Json json = dataOf(stage, views, carried(views, order), T_FC0);
  json["images"] = imagesOf(stage, views, images);
  data values = object({{"stage", stage.id},
                        {"last", std::to_string(views.size() - 1)},
                        // The page opens with the worst view.
                        {"first", std::to_string(order.front())},
                        {"has_images", !images.empty()},
                        {"json", scriptJson(json.dump())}});
  section.blocks.push_back({.html = renderTemplate(embedded::views(), values)});
  section.blocks.push_back({"The worst views", "", worstTable(stage, views, order)});
  const std::vector<Rejected> rejected = rejectedOf(views);
  if (!rejected.empty()) section.blocks.push_back(rejectedBlock(stage, views, rejected));
  return section;
}

}  // namespace plumbline::html_internal
