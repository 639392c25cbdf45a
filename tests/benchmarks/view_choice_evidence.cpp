// SPDX-License-Identifier: BSD-3-Clause
// How good are few views, and which? Curves of held-out error over the number of views for
// docs/counterfactuals.md; run by scripts/counterfactuals_evidence.py, which makes tables of them.
//
//   view_choice_evidence SESSION MODEL LOSS_PX SHAPE CAMERAS SPLIT STARTS CANDIDATES VIEWS
//       [guide] [band=SHARE]
//     MODEL radtan | equidistant; LOSS_PX of Cauchy's loss, 0: none; SHAPE flat or
//     target_shape.yaml; CAMERAS both | cam0 | cam1; SPLIT 1s | 3s (blocks, every third held out) |
//     interleaved (every third frame) | first-second | second-first (one half chosen from, the
//     other held out); guide: only the curves of a guide that the candidates are played to as they
//     were recorded: the frames that it keeps until it says stop, in their order; band=SHARE: only
//     the corners in the middle SHARE of the image's height, as of a camera that is never used
//     elsewhere
//
// Prints "pool FRAMES HELD PX", then a line per start and strategy: "curve START STRATEGY n=px
// ...", and per step of the predicted error "step START n sigma tau b E excess".
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/information/view_selection.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/target.h"
#include "evaluate/replay/counterfactual_curves.h"
#include "evaluate/replay/counterfactuals.h"
#include "evaluate/replay/frames.h"
#include "evaluate/replay/online_order.h"
#include "evaluate/replay/view_orders.h"
#include "evaluate/replay/view_pool.h"

namespace plumbline {
namespace {

constexpr int kStartViews = 3;
constexpr int kHeldOut = 150;
const int kCounts[] = {4,  5,  6,  7,  8,  9,  10, 12, 14, 16, 18,
                       20, 23, 26, 30, 35, 40, 45, 50, 60, 70, 80};

struct Asked {
  std::string session, model, shape, cameras, split;
  double cauchy_px;
  int starts, candidates, views;
  bool only_guide = false;
  double band = 1;
};

/// Leaves out what lies above and below the middle `share` of the image's height.
void keepBand(CameraStream& camera, double share) {
  const double middle = 0.5 * (camera.resolution.height - 1);
  const double most = 0.5 * share * camera.resolution.height;
  for (ImageView& view : camera.views) {
    std::erase_if(view.corners,
                  [&](const Corner& corner) { return std::abs(corner.uv.y() - middle) > most; });
  }
}

Session sessionOf(const Asked& asked) {
  Session session = readSession(asked.session);
  if (asked.shape != "flat") {
    session.target.shape = readTargetShape(asked.shape, session.target);
  }
  if (asked.cameras != "both") {
    std::erase_if(session.cameras,
                  [&](const CameraStream& camera) { return camera.name != asked.cameras; });
  }
  if (asked.band < 1) {
    for (CameraStream& camera : session.cameras) keepBand(camera, asked.band);
  }
  return session;
}

FrameSplit splitOf(const Session& session, const std::string& how) {
  FrameSplitOptions options;
  if (how == "1s" || how == "3s") {
    options.block_s = how == "1s" ? 1 : 3;
    return splitFrames(session, options);
  }
  FrameSplit split;
  const int frames = static_cast<int>(pairFrames(session.cameras).size());
  for (int f = 0; f < frames; ++f) {
    bool is_held_out = f % 3 == 2;
    if (how == "first-second") is_held_out = f >= frames / 2;
    if (how == "second-first") is_held_out = f < frames / 2;
    (is_held_out ? split.held_out : split.pool).push_back(f);
  }
  return split;
}

/// At some numbers of views, up to `most` or all of them.
std::string curveText(const ViewPool& pool, const std::vector<int>& order, int most) {
  const int end = std::min(most, static_cast<int>(order.size()));
  std::vector<int> counts;
  std::copy_if(std::begin(kCounts), std::end(kCounts), std::back_inserter(counts),
               [&](int n) { return n < end; });
  counts.push_back(end);
  std::string text;
  for (const int n : counts) {
    const auto solution = pool.solve({order.begin(), order.begin() + n});
    if (solution) text += fmt::format(" {}={:.5f}", n, pool.heldOutError(solution->estimate).px);
  }
  return text;
}

std::vector<int> picked(const std::vector<int>& from, const std::vector<int>& places) {
  std::vector<int> out;
  for (const int i : places) out.push_back(from[static_cast<std::size_t>(i)]);
  return out;
}

/// Most cells not yet covered next, after the views of the start.
std::vector<int> coverageAfter(const ViewPool& pool, const std::vector<int>& candidates,
                               const std::vector<int>& first) {
  std::vector<Frame> frames;
  for (const int f : candidates) frames.push_back(pool.frames()[static_cast<std::size_t>(f)]);
  const auto cells = cellsSeen(pool.session(), frames);
  std::vector<int> order = first;
  for (const int f : picked(candidates, coverageOrder(cells))) {
    if (std::find(first.begin(), first.end(), f) == first.end()) order.push_back(f);
  }
  return order;
}

void tellOnline(const ViewPool& pool, const std::vector<int>& candidates, ViewCriterion criterion,
                int start, int most) {
  OnlineOrderOptions options;
  options.criterion = criterion;
  options.most_views = most;
  const std::vector<int> first(candidates.begin(), candidates.begin() + kStartViews);
  const OnlineOrder found = onlineOrder(pool, candidates, first, options);
  const bool is_error = criterion == ViewCriterion::kPredictedError;
  fmt::print("curve {} {}{}\n", start, is_error ? "predicted-error" : "mi",
             curveText(pool, found.order, most));
  if (!is_error) return;
  for (const OnlineStep& s : found.steps) {
    fmt::print("step {} {} {:.4f} {:.4f} {:.4f} {:.6f} {:.5f}\n", start, s.views,
               std::sqrt(s.components.sigma2), std::sqrt(s.components.tau2),
               std::sqrt(s.components.b2), s.predicted_px2, s.excess);
  }
}

/// What the camera stage of a guide keeps of the candidates until it says stop.
std::vector<int> keptByGuide(const ViewPool& pool, const CameraStageOptions& camera,
                             const std::vector<int>& recorded, ViewCriterion criterion) {
  GuideOptions options;
  options.views.criterion = criterion;
  options.views.model() = camera.model();
  CameraGuide guide(guideRig(pool.session(), camera.models), options);
  std::vector<int> kept;
  for (const int f : recorded) {
    if (guide.finished()) break;
    const Frame& frame = pool.frames()[static_cast<std::size_t>(f)];
    GuideFrame seen{f, frame.t, {}, {}};
    for (std::size_t c = 0; c < frame.view.size(); ++c) {
      const int view = frame.view[c];
      const auto& views = pool.session().cameras[c].views;
      seen.corners.push_back(view < 0 ? std::vector<Corner>()
                                      : views[static_cast<std::size_t>(view)].corners);
    }
    const Decision d = guide.step(seen);
    for (const int gone : d.withdrawn) std::erase(kept, gone);
    if (d.accepted) kept.push_back(d.frame);
  }
  return kept;
}

int tell(const Asked& asked) {
  const Session session = sessionOf(asked);
  CameraStageOptions camera;
  camera.cauchy_px = asked.cauchy_px;
  camera.models.assign(
      session.cameras.size(),
      {ProjectionModel::kPinhole,
       asked.model == "radtan" ? DistortionModel::kRadtan : DistortionModel::kEquidistant});
  const auto pool = ViewPool::prepare(session, splitOf(session, asked.split), camera, kHeldOut);
  if (!pool) {
    fmt::print("failed\n");
    return 1;
  }
  fmt::print("pool {} {} {:.5f}\n", pool->pool().size(), pool->heldOut().size(),
             pool->heldOutError(pool->reference().estimate).px);
  const int frames = static_cast<int>(pool->pool().size());
  const auto tellGuide = [&](int start, const std::vector<int>& recorded) {
    for (const auto criterion :
         {ViewCriterion::kMutualInformation, ViewCriterion::kPredictedError}) {
      const std::vector<int> kept = keptByGuide(*pool, camera, recorded, criterion);
      fmt::print("curve {} guide-{}{}\n", start, toString(criterion),
                 curveText(*pool, kept, static_cast<int>(kept.size())));
    }
  };
  for (int start = 0; start < asked.starts; ++start) {
    std::vector<int> candidates =
        picked(pool->pool(), randomOrder(frames, 1000 + static_cast<std::uint64_t>(start)));
    candidates.resize(static_cast<std::size_t>(std::min(frames, asked.candidates)));
    std::vector<int> recorded = candidates;
    std::sort(recorded.begin(), recorded.end());
    if (asked.only_guide) {
      tellGuide(start, recorded);
      continue;
    }
    const std::vector<int> first(candidates.begin(), candidates.begin() + kStartViews);
    fmt::print("curve {} random{}\n", start, curveText(*pool, candidates, asked.views));
    fmt::print("curve {} coverage{}\n", start,
               curveText(*pool, coverageAfter(*pool, candidates, first), asked.views));
    fmt::print("curve {} recorded{}\n", start, curveText(*pool, recorded, asked.views));
    tellOnline(*pool, candidates, ViewCriterion::kMutualInformation, start, asked.views);
    tellOnline(*pool, candidates, ViewCriterion::kPredictedError, start, asked.views);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) try {
  if (argc < 10) {
    std::fputs(
        "view_choice_evidence SESSION MODEL LOSS_PX SHAPE CAMERAS SPLIT STARTS CANDIDATES VIEWS "
        "[guide] [band=SHARE]\n",
        stderr);
    return 2;
  }
  plumbline::Asked asked{argv[1],
                         argv[2],
                         argv[4],
                         argv[5],
                         argv[6],
                         std::atof(argv[3]),
                         std::atoi(argv[7]),
                         std::atoi(argv[8]),
                         std::atoi(argv[9])};
  for (int i = 10; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "guide") {
      asked.only_guide = true;
    } else if (word.starts_with("band=")) {
      asked.band = std::atof(word.c_str() + 5);
    } else {
      std::fprintf(stderr, "%s: neither guide nor band=SHARE\n", argv[i]);
      return 2;
    }
  }
  return plumbline::tell(asked);
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
