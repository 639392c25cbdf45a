// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/recording_record.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

namespace plumbline {

std::vector<ViewErrors> viewErrors(const std::vector<CornerResidual>& residuals) {
  std::map<std::pair<int, int>, ViewErrors> views;
  ViewErrors* last = nullptr;  // residuals stand view by view
  for (const CornerResidual& r : residuals) {
    if (last == nullptr || last->frame != r.frame || last->camera != r.camera) {
      last = &views[{r.frame, r.camera}];
    }
    ViewErrors& view = *last;
    view.camera = r.camera;
    view.frame = r.frame;
    view.corners.push_back(&r);
    // A rejected corner is shown with its view, but is no part of the view's figures.
    if (!r.used) continue;
    const double e2 = static_cast<double>(r.error.squaredNorm());
    ++view.used;
    view.rmse_px += e2;
    view.largest_px = std::max(view.largest_px, std::sqrt(e2));
  }
  std::vector<ViewErrors> list;
  for (auto& [key, view] : views) {
    // Not 0 where all corners were rejected: no error is no small error.
    if (view.used == 0) view.rmse_px = view.largest_px = std::nan("");
    if (view.used > 0) view.rmse_px = std::sqrt(view.rmse_px / static_cast<double>(view.used));
    list.push_back(std::move(view));
  }
  return list;
}

std::vector<std::size_t> worstFirst(const std::vector<ViewErrors>& views) {
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Stable: views of equal error keep the order of the recording, and pages their bytes.
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) {
    return views[i].used > 0 ? views[i].rmse_px : -1;
  });
  return order;
}

}  // namespace plumbline
