// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactual_curves.h"

#include <algorithm>
#include <limits>
#include <set>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

/// One point of a curve.
struct Point {
  double entropy_nats = 0;
  HeldOutError held_out;
};

/// The batch over the first `views` frames of the order; empty where it does not determine the
/// cameras.
std::optional<Point> pointAt(const ViewPool& pool, const std::vector<int>& order, int views) {
  // Any order of all of it is the reference, which has been solved.
  const bool is_whole = static_cast<std::size_t>(views) == pool.pool().size();
  const auto solution = is_whole ? std::optional(pool.reference())
                                 : pool.solve({order.begin(), order.begin() + views});
  if (!solution) return std::nullopt;
  return Point{solution->entropy_nats, pool.heldOutError(solution->estimate)};
}

void append(const std::optional<Point>& point, CounterfactualCurve& curve) {
  curve.entropy_nats.push_back(point ? std::optional(point->entropy_nats) : std::nullopt);
  const auto part = [&](double HeldOutError::*px) {
    return point ? std::optional(point->held_out.*px) : std::nullopt;
  };
  curve.held_out_px.push_back(part(&HeldOutError::px));
  curve.held_out_border_px.push_back(part(&HeldOutError::border_px));
  curve.held_out_centre_px.push_back(part(&HeldOutError::centre_px));
  curve.held_out_loss_px.push_back(part(&HeldOutError::loss_px));
}

/// A number of views in (low, high] that reaches the target with one view less missing it, where
/// `high` reaches it and `low` does not; found by halving.
int firstBetween(const ViewPool& pool, const std::vector<int>& order, int low, int high,
                 double target_px) {
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const auto point = pointAt(pool, order, middle);
    (point && point->held_out.px <= target_px ? high : low) = middle;
  }
  return high;
}

/// Of a figure of curves; empty unless all have it: quartiles over the others would be too good.
std::optional<Quartiles> quartilesOf(const std::vector<const CounterfactualCurve*>& curves,
                                     const auto& get) {
  std::vector<double> all;
  for (const CounterfactualCurve* curve : curves) {
    const std::optional<double> value = get(*curve);
    if (!value) return std::nullopt;
    all.push_back(*value);
  }
  if (all.empty()) return std::nullopt;
  return Quartiles{quantile(all, 0.25), quantile(all, 0.5), quantile(all, 0.75)};
}

/// Curves of one strategy are of one length, and so have their abscissae in common.
CounterfactualBand bandOf(const std::vector<const CounterfactualCurve*>& curves) {
  CounterfactualBand band;
  band.strategy = curves.front()->strategy;
  band.seeds = static_cast<int>(curves.size());
  band.views = curves.front()->views;
  for (std::size_t i = 0; i < band.views.size(); ++i) {
    band.entropy_nats.push_back(quartilesAt(curves, &CounterfactualCurve::entropy_nats, i));
    band.held_out_px.push_back(quartilesAt(curves, &CounterfactualCurve::held_out_px, i));
  }
  band.views_needed = quartilesOf(curves, [](const auto& curve) { return curve.views_needed; });
  return band;
}

/// Least median of all bands at a number of views; infinite where none has one.
double bestAt(const std::vector<CounterfactualBand>& bands, int views) {
  double best = std::numeric_limits<double>::infinity();
  for (const CounterfactualBand& band : bands) {
    const auto at = std::lower_bound(band.views.begin(), band.views.end(), views);
    if (at == band.views.end() || *at != views) continue;
    const auto& px = band.held_out_px[at - band.views.begin()];
    if (px) best = std::min(best, px->median);
  }
  return best;
}

}  // namespace

std::optional<int> viewsNeeded(const ViewPool& pool, const CounterfactualCurve& curve,
                               double target_px) {
  std::size_t stays = curve.views.size();  // from here on the target is kept
  while (stays > 0) {
    const auto& px = curve.held_out_px[stays - 1];
    // From the end backwards: an error that falls below the target and rises again has not come to
    // stay.
    if (!px || *px > target_px) break;
    --stays;
  }
  if (stays == curve.views.size()) return std::nullopt;
  if (stays == 0) return curve.views.front();
  return firstBetween(pool, curve.order, curve.views[stays - 1], curve.views[stays], target_px);
}

std::optional<Quartiles> quartilesAt(const std::vector<const CounterfactualCurve*>& curves,
                                     CurveValues values, std::size_t i) {
  return quartilesOf(curves, [&](const CounterfactualCurve& curve) {
    const auto& own = curve.*values;
    return i < own.size() ? own[i] : std::nullopt;
  });
}

std::vector<const CounterfactualCurve*> curvesOf(const std::vector<CounterfactualCurve>& curves,
                                                 const std::string& strategy) {
  std::vector<const CounterfactualCurve*> own;
  for (const CounterfactualCurve& curve : curves) {
    if (curve.strategy == strategy) own.push_back(&curve);
  }
  return own;
}

std::vector<int> evaluatedViews(const std::vector<CounterfactualCurve>& curves,
                                const std::vector<int>& asked) {
  std::set<int> views(asked.begin(), asked.end());
  int longest = 0;
  for (const CounterfactualCurve& curve : curves) {
    const int length = static_cast<int>(curve.order.size());
    longest = std::max(longest, length);
    views.insert(length);
  }
  if (asked.empty()) {
    views.insert({5, 8, 10, 15, 20, 30, 40});
    // 60, 80, 120, 160 ...: evenly in logarithms, since errors fall by ratios of views.
    for (int n = 60; n < longest; n *= 2) views.insert({n, 4 * n / 3});
  }
  // An order without frames has length 0.
  views.erase(views.begin(), views.lower_bound(1));
  views.erase(views.upper_bound(longest), views.end());
  return {views.begin(), views.end()};
}

std::vector<CounterfactualCurve> evaluated(const ViewPool& pool,
                                           std::vector<CounterfactualCurve> curves,
                                           const std::vector<int>& views, int threads) {
  struct Task {
    std::size_t curve;
    int views;
  };
  // One task a point, over all curves: a curve's last points take longest, and curves differ in
  // length.
  std::vector<Task> tasks;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const int length = static_cast<int>(curves[c].order.size());
    for (const int n : views) {
      if (n > length) break;
      tasks.push_back({c, n});
      curves[c].views.push_back(n);
    }
  }
  std::vector<std::optional<Point>> points(tasks.size());
  parallelCalls(static_cast<int>(tasks.size()), threads, [&](int i) {
    points[i] = pointAt(pool, curves[tasks[i].curve].order, tasks[i].views);
  });
  for (std::size_t i = 0; i < tasks.size(); ++i) append(points[i], curves[tasks[i].curve]);
  return curves;
}

std::vector<CounterfactualBand> bandsOf(const std::vector<CounterfactualCurve>& curves) {
  std::vector<CounterfactualBand> bands;
  for (const CounterfactualCurve& curve : curves) {
    if (findBand(bands, curve.strategy) != nullptr) continue;
    bands.push_back(bandOf(curvesOf(curves, curve.strategy)));
  }
  // Regret is against the best median at the same number of views, so it needs all bands.
  for (CounterfactualBand& band : bands) {
    for (std::size_t i = 0; i < band.views.size(); ++i) {
      const auto& px = band.held_out_px[i];
      band.regret_px.push_back(px ? std::optional(px->median - bestAt(bands, band.views[i]))
                                  : std::nullopt);
    }
  }
  return bands;
}

std::vector<CounterfactualCurve> withRegret(std::vector<CounterfactualCurve> curves,
                                            const std::vector<CounterfactualBand>& bands) {
  for (CounterfactualCurve& curve : curves) {
    curve.regret_px.clear();
    for (std::size_t i = 0; i < curve.views.size(); ++i) {
      const double best = bestAt(bands, curve.views[i]);
      const auto& px = curve.held_out_px[i];
      curve.regret_px.push_back(px && best < std::numeric_limits<double>::infinity()
                                    ? std::optional(*px - best)
                                    : std::nullopt);
    }
  }
  return curves;
}

const CounterfactualBand* findBand(const std::vector<CounterfactualBand>& bands,
                                   const std::string& strategy) {
  return findBy(bands, &CounterfactualBand::strategy, strategy);
}

}  // namespace plumbline
