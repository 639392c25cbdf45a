// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/calibration/views_section.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "generated/report/embedded.h"
#include "report/html/page_data.h"
#include "report/html/text.h"

namespace plumbline::html_internal {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kWorst = 8;          // views in the table
constexpr std::size_t kMostCorners = 1e5;  // that a page carries; 8 bytes each
constexpr double kQuarter = 4;             // steps per pixel of a corner
constexpr double kMilli = 1000;            // and of an error; 32 px and more are one

struct View {
  int camera = 0, frame = 0;
  double rmse_px = 0, largest_px = 0;
  std::size_t used = 0;
  std::vector<const CornerResidual*> corners = {};
};

std::vector<View> viewsOf(const StageView& stage) {
  std::map<std::pair<int, int>, View> views;  // in the order of time
  for (const CornerResidual& r : stage.residuals) {
    View& view = views[{r.frame, r.camera}];
    view.camera = r.camera;
    view.frame = r.frame;
    view.corners.push_back(&r);
    if (!r.used) continue;
    const double e2 = static_cast<double>(r.error.squaredNorm());
    ++view.used;
    view.rmse_px += e2;
    view.largest_px = std::max(view.largest_px, std::sqrt(e2));
  }
  std::vector<View> list;
  for (auto& [key, view] : views) {
    if (view.used > 0) view.rmse_px = std::sqrt(view.rmse_px / static_cast<double>(view.used));
    list.push_back(std::move(view));
  }
  return list;
}

/// Indices from the worst view on.
std::vector<std::size_t> worstFirst(const std::vector<View>& views) {
  std::vector<std::size_t> order(views.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return views[a].rmse_px > views[b].rmse_px;
  });
  return order;
}

/// Which views bring their corners: all if they are few, else the worst hundred and every n-th.
std::vector<bool> carried(const std::vector<View>& views, const std::vector<std::size_t>& order) {
  constexpr std::size_t worst = 100;
  std::size_t all = 0;
  for (const View& view : views) all += view.corners.size();
  const std::size_t step = (all + kMostCorners - 1) / kMostCorners;
  std::vector<bool> kept(views.size(), false);
  for (std::size_t i = 0; i < views.size(); ++i) kept[i] = step <= 1 || i % step == 0;
  for (std::size_t i = 0; i < std::min(worst, order.size()); ++i) kept[order[i]] = true;
  return kept;
}

std::int16_t packed(double value, double scale) {
  return static_cast<std::int16_t>(std::lround(std::clamp(scale * value, -32767.0, 32767.0)));
}

/// Rows [camera, frame, RMSE, largest, used, first corner or -1, corners]; corners as u, v, e_u,
/// e_v, a rejected one with its u below zero less one step.
Json dataOf(const StageView& stage, const std::vector<View>& views, const std::vector<bool>& kept,
            const std::vector<Transform>& T_FC0) {
  Json rows = Json::array();
  std::vector<std::int16_t> corners;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& v = views[i];
    const auto first = kept[i] ? static_cast<std::int64_t>(corners.size() / 4) : -1;
    rows.push_back({v.camera, v.frame, std::round(1e4 * v.rmse_px) / 1e4,
                    std::round(1e3 * v.largest_px) / 1e3, v.used, first, v.corners.size()});
    if (!kept[i]) continue;
    for (const CornerResidual* r : v.corners) {
      const std::int16_t u = packed(std::max(r->uv.x(), 0.0F), kQuarter);
      corners.push_back(static_cast<std::int16_t>(r->used ? u : -1 - u));
      corners.push_back(packed(r->uv.y(), kQuarter));
      corners.push_back(packed(r->error.x(), kMilli));
      corners.push_back(packed(r->error.y(), kMilli));
    }
  }
  Json cameras = Json::array(), seconds = Json::array(), poses = Json::array();
  for (const CameraCalibration& c : stage.cameras) {
    const Resolution size = c.intrinsics.resolution;
    cameras.push_back({{"name", c.name}, {"width", size.width}, {"height", size.height}});
  }
  for (const double s : frameSeconds(stage.frames)) seconds.push_back(std::round(1e3 * s) / 1e3);
  for (const Transform& T : T_FC0) {  // place [mm], and the angle between axis and target's normal
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

Table worstTable(const StageView& stage, const std::vector<View>& views,
                 const std::vector<std::size_t>& order) {
  Table table{{{"View", Cell::Kind::kTight},
               {"Time [s]", kNumber},
               {"RMSE [px]", kNumber},
               {"Largest error [px]", kNumber},
               {"Corners used", kNumber},
               {"Rejected", kNumber}},
              {}};
  const std::vector<double> seconds = frameSeconds(stage.frames);
  for (std::size_t i = 0; i < std::min(kWorst, order.size()); ++i) {
    const View& v = views[order[i]];
    Cell name = tight(fmt::format("{}, frame {}",
                                  stage.cameras[static_cast<std::size_t>(v.camera)].name, v.frame));
    name.link = fmt::format("#{}-view-{}", stage.id, order[i]);
    table.rows.push_back(
        {std::move(name), number(fmt::format("{:.2f}", seconds[static_cast<std::size_t>(v.frame)])),
         number(fmt::format("{:.3f}", v.rmse_px)), number(fmt::format("{:.2f}", v.largest_px)),
         number(std::to_string(v.used)), number(std::to_string(v.corners.size() - v.used))});
  }
  return table;
}

}  // namespace

Section viewsSection(const StageView& stage, const std::vector<Transform>& T_FC0) {
  Section section{"views",
                  "Single views",
                  "Pick a view: click a moment in any plot over time, a row of the worst views, or "
                  "move the slider. Arrows are errors, measured minus projected, magnified; "
                  "rejected corners are crosses.",
                  {},
                  {}};
  const std::vector<View> views = viewsOf(stage);
  if (views.empty()) return section;
  const std::vector<std::size_t> order = worstFirst(views);
  data values{data::type::object};
  values.set("stage", stage.id);
  values.set("last", std::to_string(views.size() - 1));
  values.set("first", std::to_string(order.front()));
  values.set("json", scriptJson(dataOf(stage, views, carried(views, order), T_FC0).dump()));
  Block block;
  block.html = renderTemplate(embedded::views(), values);
  section.blocks.push_back(std::move(block));
  section.blocks.push_back({"The worst views", "", worstTable(stage, views, order), {}, {}});
  return section;
}

}  // namespace plumbline::html_internal
