// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "evaluate/replay/counterfactual_curves.h"
#include "evaluate/replay/counterfactuals.h"

namespace plumbline {
namespace {

constexpr int kComparedViews = 80;  // at most
constexpr double kTie = 0.005;      // relative difference of errors that is not worth a word

/// Greedy MI beside the random orders at one number of views.
struct Comparison {
  double greedy = 0;
  Quartiles random;
  int seeds = 0;

  // Below zero greedy MI is the better one.
  double relative() const { return greedy / random.median - 1; }
  std::string px() const {
    if (seeds == 1) return fmt::format("{:.4g} px against {:.4g} px", greedy, random.median);
    return fmt::format("{:.4g} px against {:.4g} px (quartiles {:.4g} to {:.4g})", greedy,
                       random.median, random.lower, random.upper);
  }
};

/// "gains 5.2 %", "loses 0.9 %", "ties".
std::string outcome(const Comparison& c) {
  if (std::abs(c.relative()) < kTie) return "ties";
  return fmt::format("{} {:.1f} %", c.relative() < 0 ? "gains" : "loses",
                     100 * std::abs(c.relative()));
}

std::string rangeOf(const Quartiles& q, int seeds) {
  if (seeds == 1) return fmt::format("{:.0f}", q.median);
  return fmt::format("{:.0f} (quartiles {:.0f} to {:.0f} over {} seeds)", q.median, q.lower,
                     q.upper, seeds);
}

class Remarks {
 public:
  Remarks(const ViewPool& pool, const Counterfactuals& found)
      : pool_(pool),
        found_(found),
        greedy_(curvesOf(found.curves, "greedy-mi")),
        random_(curvesOf(found.curves, "random")) {
    at_ = comparedPlace();
  }

  std::vector<std::string> all(int guide_frames) {
    needed();
    if (at_) {
      parameters();
      regions();
      choice();
      loss();
      otherModel();
      where();
    }
    guide(guide_frames);
    return std::move(out_);
  }

 private:
  /// The last abscissa up to 80 views or half of the pool, whichever is less, where both have a
  /// value: close to the whole pool all orders hold nearly the same frames.
  std::optional<std::size_t> comparedPlace() const {
    std::optional<std::size_t> place;
    if (greedy_.empty() || random_.empty()) return place;
    const int most = std::min(kComparedViews, found_.pool_frames / 2);
    const std::vector<int>& views = greedy_.front()->views;
    for (std::size_t i = 0; i < views.size() && views[i] <= most; ++i) {
      if (compared(&CounterfactualCurve::held_out_px, i)) place = i;
    }
    return place;
  }

  std::optional<Comparison> compared(CurveValues values, std::size_t i) const {
    const auto greedy = quartilesAt(greedy_, values, i);
    const auto random = quartilesAt(random_, values, i);
    if (!greedy || !random) return std::nullopt;
    return Comparison{greedy->median, *random, static_cast<int>(random_.size())};
  }

  Comparison here(CurveValues values) const { return *compared(values, *at_); }
  int views() const { return greedy_.front()->views[*at_]; }

  void needed() {
    std::vector<std::string> parts;
    for (const CounterfactualBand& band : found_.bands) {
      parts.push_back(
          band.strategy + " " +
          (band.views_needed ? rangeOf(*band.views_needed, band.seeds) : notNeededText(band)));
    }
    out_.push_back(
        fmt::format("Views needed to come within 10 % of the held-out error of the whole pool "
                    "({:.4g} px with {} frames) and stay there: {}.",
                    found_.full_pool_held_out_px, found_.pool_frames, fmt::join(parts, ", ")));
  }

  void parameters() {
    const Comparison entropy = here(&CounterfactualCurve::entropy_nats);
    const Comparison error = here(&CounterfactualCurve::held_out_px);
    // Entropy falls as parameters become certain.
    const double nats = entropy.random.median - entropy.greedy;
    out_.push_back(fmt::format(
        "With {} views the parameters of greedy MI are {:.2f} nats {} certain than those of "
        "random; its held-out error is {}: it {}.",
        views(), std::abs(nats), nats >= 0 ? "more" : "less", error.px(), outcome(error)));
  }

  void regions() {
    const Comparison border = here(&CounterfactualCurve::held_out_border_px);
    const Comparison centre = here(&CounterfactualCurve::held_out_centre_px);
    const double share = pool_.heldOutError(pool_.reference().estimate).border_share;
    // Without corners there, 0 px is no error (HeldOutError).
    if (share == 0 || border.random.median == 0) return;
    out_.push_back(fmt::format(
        "Near the image's border (within a tenth of its width or height, {:.1f} % of the held-out "
        "corners) the error of greedy MI is {}: it {}; over the other corners {}: it {}.",
        100 * share, border.px(), outcome(border), centre.px(), outcome(centre)));
  }

  struct Corners {
    double border_share = 0;
    double rmse_px = 0;
  };
  Corners cornersOf(const std::vector<int>& frames) const {
    Corners c;
    double count = 0;
    for (const ViewPool::ImageError& e : pool_.referenceErrors(frames)) {
      ++count;
      c.border_share += e.is_border ? 1 : 0;
      c.rmse_px += e.squared_px;
    }
    c.border_share /= std::max(count, 1.0);
    c.rmse_px = std::sqrt(c.rmse_px / std::max(count, 1.0));
    return c;
  }

  /// What greedy MI picks.
  void choice() {
    // Both at one calibration, that of the whole pool, so that only the choice of corners differs.
    const std::vector<int>& order = greedy_.front()->order;
    const Corners picked = cornersOf({order.begin(), order.begin() + views()});
    const Corners all = cornersOf(pool_.pool());
    out_.push_back(fmt::format(
        "{:.1f} % of the corners of greedy MI's first {} views lie near the border, against {:.1f} "
        "% of the whole pool's, from which random draws; under the calibration from the whole pool "
        "their RMSE is {:.4g} px against {:.4g} px, while mutual information assumes that the "
        "model describes all corners equally well.",
        100 * picked.border_share, views(), 100 * all.border_share, picked.rmse_px, all.rmse_px));
  }

  void loss() {
    const Comparison rmse = here(&CounterfactualCurve::held_out_px);
    const Comparison robust = here(&CounterfactualCurve::held_out_loss_px);
    // Where the loss changes nothing it is not worth a sentence.
    if (std::abs(rmse.relative() - robust.relative()) < kTie) return;
    out_.push_back(
        fmt::format("Under the batch's robust loss, which limits the influence of gross errors, "
                    "the held-out error of greedy MI is {}: it {}.",
                    robust.px(), outcome(robust)));
  }

  void otherModel() {
    const CounterfactualBand* greedy = findBand(found_.other_model_bands, "greedy-mi");
    const CounterfactualBand* random = findBand(found_.other_model_bands, "random");
    if (greedy == nullptr || random == nullptr) return;
    const auto at = std::lower_bound(greedy->views.begin(), greedy->views.end(), views());
    const auto i = static_cast<std::size_t>(at - greedy->views.begin());
    if (at == greedy->views.end() || *at != views() || i >= random->held_out_px.size()) return;
    if (!greedy->held_out_px[i] || !random->held_out_px[i] || !random->held_out_px.back()) return;
    // held_out_px.back() is the whole pool's, as of any order that holds all of it.
    const Comparison there{greedy->held_out_px[i]->median, *random->held_out_px[i], random->seeds};
    const Comparison own = here(&CounterfactualCurve::held_out_px);
    out_.push_back(fmt::format(
        "With {} the error of the whole pool on the held-out frames is {:.4g} px instead of {:.4g} "
        "px, and that of greedy MI's {} views {}: it {} there, {} it {} with this model.",
        found_.other_model, random->held_out_px.back()->median, found_.full_pool_held_out_px,
        views(), there.px(), outcome(there), outcome(there) == outcome(own) ? "as" : "while",
        outcome(own)));
  }

  /// At which numbers of views greedy MI is outside of random's quartiles.
  void where() {
    int counted = 0;
    std::vector<int> above, below;
    const std::vector<int>& views = greedy_.front()->views;
    // Not the last one: all orders hold the same frames there.
    for (std::size_t i = 0; i + 1 < views.size(); ++i) {
      const auto c = compared(&CounterfactualCurve::held_out_px, i);
      if (!c) continue;
      ++counted;
      // With one seed both quartiles are its value: a tie shall not count as outside.
      if (c->greedy > c->random.upper * (1 + kTie)) above.push_back(views[i]);
      if (c->greedy < c->random.lower * (1 - kTie)) below.push_back(views[i]);
    }
    const auto list = [](const std::vector<int>& at) {
      return at.empty() ? std::string("none") : fmt::format("{}", fmt::join(at, ", "));
    };
    out_.push_back(
        fmt::format("Of {} numbers of views greedy MI's held-out error is above random's quartiles "
                    "at {} ({}) and below them at {} ({}), by more than {:.1f} %.",
                    counted, above.size(), list(above), below.size(), list(below), 100 * kTie));
  }

  void guide(int guide_frames) {
    if (guide_frames == 0) return;
    const auto guide = curvesOf(found_.curves, "guide");
    const int used = guide.empty() ? 0 : static_cast<int>(guide.front()->order.size());
    if (used == guide_frames) {
      out_.push_back(
          fmt::format("All {} frames that the guide kept are in the pool and on its curve.", used));
      return;
    }
    out_.push_back(fmt::format(
        "Of {} frames that the guide kept {} are in the pool and on its curve; {} in or beside "
        "held-out blocks, or {} no plausible pose.",
        guide_frames, used, guide_frames - used == 1 ? "the other lies" : "the others lie",
        guide_frames - used == 1 ? "has" : "have"));
  }

  const ViewPool& pool_;
  const Counterfactuals& found_;
  std::vector<const CounterfactualCurve*> greedy_;
  std::vector<const CounterfactualCurve*> random_;
  std::optional<std::size_t> at_;
  std::vector<std::string> out_;
};

}  // namespace

std::vector<std::string> counterfactualRemarks(const ViewPool& pool, const Counterfactuals& found,
                                               int guide_frames) {
  return Remarks(pool, found).all(guide_frames);
}

}  // namespace plumbline
