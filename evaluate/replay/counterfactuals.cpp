// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactuals.h"

#include <algorithm>
#include <utility>

#include "calibrator/base/error.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/replay/view_pool.h"

namespace plumbline {
namespace {

constexpr double kEnough = 1.1;  // times the full pool's held-out error

/// pinhole-equidistant for pinhole-radtan, which has as many coefficients; pinhole-radtan for any
/// other pinhole; empty where a camera is no pinhole.
std::vector<CameraModelPair> otherModels(const CameraEstimate& cameras) {
  std::vector<CameraModelPair> models;
  for (const Intrinsics& camera : cameras.intrinsics) {
    if (camera.projection_model != ProjectionModel::kPinhole) return {};
    const bool is_radtan = camera.distortion_model == DistortionModel::kRadtan;
    models.push_back({ProjectionModel::kPinhole,
                      is_radtan ? DistortionModel::kEquidistant : DistortionModel::kRadtan});
  }
  return models;
}

/// Entropies, held-out errors and views needed of all orders.
std::vector<CounterfactualCurve> judged(const ViewPool& pool,
                                        std::vector<CounterfactualCurve> curves, double full_px,
                                        const CounterfactualOptions& options) {
  const auto views = evaluatedViews(curves, options.views);
  curves = evaluated(pool, std::move(curves), views, options.threads);
  // The pool's own error as the measure: below it views are not what is missing.
  return withViewsNeeded(pool, std::move(curves), kEnough * full_px, options.threads);
}

/// Greedy MI and random orders under another model, on the same split.
void addOtherModel(const ViewPool& first, const FrameSplit& split,
                   const CounterfactualOptions& options, Counterfactuals& out) {
  CameraStageOptions camera = options.camera;
  camera.models = otherModels(first.reference().estimate);
  // Given cameras are of the first model.
  camera.start.clear();
  if (camera.models.empty()) return;
  // From scratch, as its poses and the corners that it leaves out are the other model's own.
  const auto pool = ViewPool::prepare(first.session(), split, camera, options.max_held_out);
  if (!pool) return;
  auto curves = strategyOrders(*pool, {}, options);
  std::erase_if(curves, [](const CounterfactualCurve& c) {
    return c.strategy != "random" && c.strategy != "greedy-mi" && c.strategy != "predicted-error";
  });
  // Of this model: "enough" is relative to what it can do itself.
  const double full_px = pool->heldOutError(pool->reference().estimate).px;
  curves = judged(*pool, std::move(curves), full_px, options);
  out.other_model = "pinhole-" + toString(camera.models.front().distortion);
  out.other_model_bands = bandsOf(curves);
}

}  // namespace

void CounterfactualOptions::check() const {
  split.check();
  if (random_seeds < 1) throw InputError("at least one random order is needed");
  if (online_views < 4) throw InputError("an order by predicted error has four views or more");
  if (max_held_out < 1) throw InputError("at least one frame must be held out");
  if (std::any_of(views.begin(), views.end(), [](int n) { return n < 1; })) {
    throw InputError("numbers of views are 1 or more");
  }
}

Counterfactuals counterfactuals(const Session& session, const std::vector<int>& guide_frames,
                                const CounterfactualOptions& options) {
  return counterfactuals(session, splitFrames(session, options.split, options.camera.frames),
                         guide_frames, options);
}

Counterfactuals counterfactuals(const Session& session, const FrameSplit& split,
                                const std::vector<int>& guide_frames,
                                const CounterfactualOptions& options) {
  options.check();
  Counterfactuals out;
  CameraStageOptions camera = options.camera;
  camera.threads = options.threads;
  const auto pool = ViewPool::prepare(session, split, camera, options.max_held_out);
  if (!pool) {
    out.problem = problemOf(pool.failure());
    return out;
  }
  out.pool_frames = static_cast<int>(pool->pool().size());
  out.held_out_frames = static_cast<int>(pool->heldOut().size());
  out.full_pool_entropy_nats = pool->reference().entropy_nats;
  out.full_pool_held_out_px = pool->heldOutError(pool->reference().estimate).px;
  const auto curves = judged(*pool, strategyOrders(*pool, guide_frames, options),
                             out.full_pool_held_out_px, options);
  out.bands = bandsOf(curves);
  out.curves = withRegret(curves, out.bands);
  if (options.other_model) addOtherModel(*pool, split, options, out);
  out.remarks = counterfactualRemarks(*pool, out, static_cast<int>(guide_frames.size()));
  return out;
}

}  // namespace plumbline
