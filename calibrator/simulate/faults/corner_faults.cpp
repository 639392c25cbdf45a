// SPDX-License-Identifier: BSD-3-Clause
// What happens to corners after they were seen: disturbViews().
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "calibrator/simulate/faults/view_faults.h"

namespace plumbline {
namespace {

using enum FaultKind;

/// Numbers are drawn for every corner of the target, seen or not. Corners stay in the image.
void displaceCorners(ImageView& view, const Resolution& size, const AprilGrid& target,
                     const Fault& fault, RandomStream& random) {
  auto corner = view.corners.begin();
  for (int id = 0; id < target.cornerCount() && corner != view.corners.end(); ++id) {
    const bool is_false = random.uniform() < fault.value;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double length = fault.extent * random.uniform(0.5, 1.5);
    if (corner->id != id) continue;
    if (is_false) {
      corner->uv += length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      corner->uv.x() = std::clamp(corner->uv.x(), 0.0, size.width - 1.0);
      corner->uv.y() = std::clamp(corner->uv.y(), 0.0, size.height - 1.0);
    }
    ++corner;
  }
}

/// Returns whether any tag has another's place in the end: a later exchange may undo one.
bool swapIds(ImageView& view, const AprilGrid& target, const Fault& fault, RandomStream& random) {
  std::vector<int> seen;
  for (const Corner& corner : view.corners) {
    if (seen.empty() || seen.back() != corner.id / 4) seen.push_back(corner.id / 4);
  }
  std::vector<int> id_of_tag(static_cast<std::size_t>(target.tagCount()));
  std::iota(id_of_tag.begin(), id_of_tag.end(), 0);
  for (int tag = 0; tag < target.tagCount(); ++tag) {
    // Both for every tag, struck and seen or not.
    const bool is_struck = random.uniform() < fault.value;
    const double choice = random.uniform();
    const auto own = std::find(seen.begin(), seen.end(), tag);
    if (!is_struck || own == seen.end() || seen.size() < 2) continue;
    // One of the others: the own place is left out.
    const auto step =
        1 + static_cast<std::ptrdiff_t>(choice * static_cast<double>(seen.size() - 1));
    const auto place = (own - seen.begin() + step) % static_cast<std::ptrdiff_t>(seen.size());
    const int other = seen[place];
    std::swap(id_of_tag[tag], id_of_tag[other]);
  }
  for (Corner& corner : view.corners) {
    corner.id = 4 * id_of_tag[corner.id / 4] + corner.id % 4;
  }
  // Ids ascend in every view, with wrong ids as well.
  std::sort(view.corners.begin(), view.corners.end(),
            [](const Corner& a, const Corner& b) { return a.id < b.id; });
  return !std::is_sorted(id_of_tag.begin(), id_of_tag.end());
}

/// The mean time between frames [s].
double framePeriod(const std::vector<FaultyFrame>& frames) {
  if (frames.size() < 2) return 0;
  const auto steps = static_cast<double>(frames.back().number - frames.front().number);
  return (frames.back().t_s - frames.front().t_s) / steps;
}

}  // namespace

void disturbViews(CameraStream& stream, const std::vector<FaultyFrame>& frames, int index,
                  const SimulationOptions& o, std::vector<InjectedFault>& injected) {
  const auto camera = static_cast<std::uint64_t>(index);
  // Turns a rate per second into a chance per frame.
  const double period_s = framePeriod(frames);
  for (const NumberedFault& f : faultsOf(o.faults, {kFalseCorners, kSwappedIds, kFrozen})) {
    if (f->camera.value_or(index) != index) continue;
    auto& stamps = injected[f.fault - o.faults.data()].stamps;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      ImageView& view = stream.views[k];
      RandomStream random = f.random(o.seed, camera, frames[k].number);
      if (f->kind == kFalseCorners) {
        displaceCorners(view, stream.resolution, o.target, *f.fault, random);
      } else if (f->kind == kSwappedIds) {
        if (swapIds(view, o.target, *f.fault, random)) stamps.push_back(view.t);
      } else if (random.uniform() < f->value * period_s && k > 0) {
        // As that view is by now: of several frozen in a row all repeat the first one's.
        view.corners = stream.views[k - 1].corners;
        stamps.push_back(view.t);
      }
    }
    std::sort(stamps.begin(), stamps.end());
    // One list for all cameras, which mostly share their stamps.
    stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  }
}

}  // namespace plumbline
