// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactuals.h"

#include <algorithm>
#include <set>
#include <utility>

#include "calibrator/base/error.h"
#include "calibrator/base/parallel.h"
#include "calibrator/information/view_selection.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/replay/counterfactual_curves.h"
#include "evaluate/replay/online_order.h"
#include "evaluate/replay/view_orders.h"

namespace plumbline {
namespace {

CounterfactualCurve curveOf(const char* strategy, std::vector<int> order, std::uint64_t seed = 0) {
  CounterfactualCurve curve;
  curve.strategy = strategy;
  curve.seed = seed;
  curve.order = std::move(order);
  return curve;
}

/// Those frames of the guide that can be used, each once.
std::vector<int> guideOrder(const ViewPool& pool, const std::vector<int>& guide_frames) {
  std::set<int> left(pool.pool().begin(), pool.pool().end());
  std::vector<int> order;
  for (const int f : guide_frames) {
    if (left.erase(f) > 0) order.push_back(f);
  }
  return order;
}

/// By predicted error, each decision at the estimate of its time.
std::vector<int> predictedErrorOrder(const ViewPool& pool, const CounterfactualOptions& options) {
  constexpr int kStart = 3;
  const int count = static_cast<int>(pool.pool().size());
  if (count < kStart) return {};
  // No error can be predicted before there are cameras: the first views are the first of random.
  std::vector<int> first = itemsAt(pool.pool(), randomOrder(count, options.seed));
  first.resize(kStart);
  OnlineOrderOptions online;
  online.most_views = options.online_views;
  return onlineOrder(pool, pool.pool(), first, online).order;
}

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
  parallelCalls(static_cast<int>(curves.size()), options.threads, [&](int i) {
    curves[i].views_needed = viewsNeeded(pool, curves[i], kEnough * full_px);
  });
  return curves;
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

std::vector<CounterfactualCurve> strategyOrders(const ViewPool& pool,
                                                const std::vector<int>& guide_frames,
                                                const CounterfactualOptions& options) {
  const int count = static_cast<int>(pool.pool().size());
  // Positions in the pool are ascending in time: that is the order as recorded.
  std::vector<CounterfactualCurve> curves = {curveOf("recorded", pool.pool())};
  for (int i = 0; i < options.random_seeds; ++i) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
    curves.push_back(curveOf("random", itemsAt(pool.pool(), randomOrder(count, seed)), seed));
  }
  const auto greedy = greedyInformationOrder(pool.poolInformation());
  if (!greedy.empty()) curves.push_back(curveOf("greedy-mi", itemsAt(pool.pool(), greedy)));
  auto online = predictedErrorOrder(pool, options);
  if (!online.empty()) curves.push_back(curveOf("predicted-error", std::move(online)));
  const auto covering =
      coverageOrder(cellsSeen(pool.session(), itemsAt(pool.frames(), pool.pool())));
  curves.push_back(curveOf("coverage", itemsAt(pool.pool(), covering)));
  std::vector<int> guide = guideOrder(pool, guide_frames);
  if (!guide.empty()) curves.push_back(curveOf("guide", std::move(guide)));
  return curves;
}

void CounterfactualOptions::check() const {
  split.check();
  if (random_seeds < 1) throw InputError("at least one random order is needed");
  if (online_views < 4) throw InputError("an order by predicted error has four views or more");
  if (max_held_out < 1) throw InputError("at least one frame must be held out");
  if (std::ranges::any_of(views, [](int n) { return n < 1; })) {
    throw InputError("numbers of views are 1 or more");
  }
}

Counterfactuals counterfactuals(const Session& session, const std::vector<int>& guide_frames,
                                const CounterfactualOptions& options,
                                const std::optional<FrameSplit>& given_split) {
  options.check();
  Counterfactuals out;
  const FrameSplit split =
      given_split ? *given_split : splitFrames(session, options.split, options.camera.frames);
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
