// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/history.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "calibrator/base/statistics/statistics.h"

namespace plumbline {
namespace {

constexpr double kMadToSigma = 1.4826;  // of a normal distribution
constexpr const char* kFailedFigure = "failed";

/// How a figure is judged, by the first part of its name; more is worse.
struct Judged {
  const char* name;
  double least;  ///< a deviation is at least this, in the figure's unit
};

// Entropies may be near 0, and so have no share of themselves to compare with; a hundredth of a nat
// is a hundredth of a parameter's standard deviation. Offsets are compared with what a clock
// resolves.
constexpr std::array<Judged, 8> kJudged{{{kFailedFigure, 0.1},
                                         {"camera_rmse_px", 1e-6},
                                         {"camera_imu_rmse_px", 1e-6},
                                         {"held_out_rmse_px", 1e-6},
                                         {"camera_entropy_nats", 0.01},
                                         {"camera_imu_entropy_nats", 0.01},
                                         {"perturbation_error_ms", 1e-4},
                                         {"ate_m", 1e-6}}};

/// The part before the slash: "held_out_rmse_px" of "held_out_rmse_px/eval01".
std::string familyOf(const std::string& name) { return name.substr(0, name.find('/')); }

/// A figure is judged as all of its family. Null for figures that are kept and not judged.
const Judged* judgedAs(const std::string& name) {
  const std::string family = familyOf(name);
  const auto found = std::ranges::find(kJudged, family, &Judged::name);
  return found == kJudged.end() ? nullptr : &*found;
}

// Nobody expects the same seconds twice.
bool isDuration(const std::string& name) { return name.compare(0, 13, "calibration_s") == 0; }

/// The median absolute deviation from `middle`, as a normal distribution's sigma: a single bad
/// night does not widen it.
double deviation(const std::vector<double>& values, double middle) {
  std::vector<double> distances;
  for (const double value : values) distances.push_back(std::abs(value - middle));
  return kMadToSigma * median(distances);
}

/// One figure's nights under the inputs that it has on the last one, since it was last accepted.
struct Series {
  const StudyFigure* last = nullptr;
  std::vector<std::pair<int, double>> values;  ///< night, value
  /// The values, but of bad nights (judgeMedian()) the median that they were compared with.
  std::vector<double> without_jumps;
};

/// Of a study's sessions on one night, as shares of their first nights' values.
struct Changes {
  std::vector<double> all, without_jumps;
};

bool concerns(const StudyAcceptance& a, const StudyFigure& f) {
  const bool session = a.session.empty() || a.session == f.session;
  const bool name = a.name.empty() || a.name == f.name || a.name == familyOf(f.name);
  return session && name;
}

/// The night from which the figure is judged: that of the last acceptance that concerns it.
int startOf(const StudyFigure& figure, const std::vector<StudyAcceptance>& accepted) {
  int start = 1;
  for (const StudyAcceptance& a : accepted) {
    if (concerns(a, figure)) start = std::max(start, a.night);
  }
  return start;
}

class Judge {
 public:
  Judge(int night, const std::vector<StudyAcceptance>& accepted,
        const RegressionThresholds& thresholds)
      : night_(night), accepted_(accepted), t_(thresholds) {}

  // In the order of StudyStore::figures(): by session and name, so that the spans of a figure are
  // neighbours.
  std::vector<StudyAlarm> judge(const std::vector<FigureSpan>& figures) {
    for (std::size_t begin = 0, end = 0; begin < figures.size(); begin = end) {
      while (end < figures.size() && figures[end].figure.session == figures[begin].figure.session &&
             figures[end].figure.name == figures[begin].figure.name) {
        ++end;
      }
      // A view of them: a series keeps the last of its figures until the study is judged.
      judgeFigure(std::span(figures).subspan(begin, end - begin));
    }
    for (const auto& [name, list] : of_study_) judgeStudy(name, list);
    return std::move(alarms_);
  }

 private:
  // Spans of one figure in the order of nights; equal values of successive nights are one span.
  void judgeFigure(std::span<const FigureSpan> spans) {
    // No figure of this night: its step is no longer planned, or gave none; the latter is a figure
    // itself, "failed".
    if (spans.back().last_night != night_) return;
    const StudyFigure& last = spans.back().figure;
    Series series;
    series.last = &last;
    const int start = startOf(last, accepted_);
    for (const FigureSpan& span : spans) {
      // Other data are another series; another version is not, for it is what may have made things
      // worse.
      if (span.figure.inputs_key != last.inputs_key) continue;
      for (int night = std::max(start, span.first_night); night <= span.last_night; ++night) {
        if (std::isfinite(span.figure.value)) series.values.emplace_back(night, span.figure.value);
      }
    }
    // A value that is not reproduced is no change for the worse of anything: there is one alarm,
    // not two.
    if (judgeDeterministic(spans, start)) return;
    const Judged* how = judgedAs(last.name);
    if (how == nullptr || !std::isfinite(last.value) || series.values.empty()) return;
    judgeMedian(series, *how);
    if (!last.session.empty()) {
      // By family: each recording of a session is a series among the others.
      of_study_[familyOf(last.name)].push_back(std::move(series));
    }
  }

  bool judgeDeterministic(std::span<const FigureSpan> spans, int start) {
    const StudyFigure& last = spans.back().figure;
    if (isDuration(last.name)) return false;
    // A step may fail for what is in no key (memory, a missing program): done again it is mended.
    const bool only_worse = familyOf(last.name) == kFailedFigure;
    for (const FigureSpan& span : spans) {
      const bool same = span.figure.inputs_key == last.inputs_key &&
                        span.figure.version == last.version && span.last_night >= start;
      if (!same || span.figure == last) continue;
      if (only_worse && span.figure.value >= last.value) continue;
      add(last, spans.back().first_night, "deterministic", span.figure.value, last.value);
      return true;
    }
    return false;
  }

  void judgeMedian(Series& series, const Judged& how) {
    const bool failure = familyOf(how.name) == kFailedFigure;
    std::vector<double> good;
    int first_bad = 0;
    double was = 0;
    for (const auto& [night, value] : series.values) {
      if (!good.empty()) {
        const auto count = static_cast<std::ptrdiff_t>(std::min(good.size(), window()));
        const std::vector<double> recent(good.end() - count, good.end());
        // What was done once can be done, however often it failed: the least in place of the
        // median, and no deviation.
        const double middle = failure ? *std::ranges::min_element(recent) : median(recent);
        const double scale =
            failure ? how.least
                    : std::max({deviation(recent, middle), t_.floor * std::abs(middle), how.least});
        if (value - middle > t_.sigma * scale) {
          // Not among the good ones: a step that stays would become the median and end its own
          // alarm.
          if (first_bad == 0) first_bad = night;
          was = middle;
          series.without_jumps.push_back(good.back());
          continue;
        }
      }
      first_bad = 0;
      good.push_back(value);
      series.without_jumps.push_back(value);
    }
    if (first_bad > 0) add(*series.last, first_bad, "median", was, series.last->value);
  }

  void judgeStudy(const std::string& name, const std::vector<Series>& list) {
    const Judged& how = *judgedAs(name);
    std::map<int, Changes> changes;
    for (const Series& series : list) {
      const double reference = series.values.front().second;
      // Where a figure is near 0: a change by `least` is then one by `floor`, the least deviation.
      const double unit = std::max(std::abs(reference), how.least / t_.floor);
      for (std::size_t i = 0; i < series.values.size(); ++i) {
        const auto& [night, value] = series.values[i];
        changes[night].all.push_back((value - reference) / unit);
        changes[night].without_jumps.push_back((series.without_jumps[i] - reference) / unit);
      }
    }
    std::vector<double> ordinary;  // the first nights of the window, as far as they had come
    double sum = 0;
    int first = 0;
    for (const auto& [night, values] : changes) {
      // A jump that is alarmed as one is no drift as well.
      const double last = median(values.without_jumps);
      if (ordinary.size() < window()) ordinary.push_back(last);
      // As it was on that night: later ones, which may be those that are looked for, would change
      // what a night adds, and with it the alarms of nights that are as they were.
      const double scale = std::max(deviation(ordinary, median(ordinary)), t_.floor);
      // Page's one-sided cumulated sum (1954): slack is the drift a night that is let pass.
      const double step = last / scale - t_.slack;
      // After an alarm it begins anew with a night that is in order: it would else stay high for as
      // long as the nights before were far off.
      sum = sum > t_.cusum && step <= 0 ? 0 : std::max(0.0, sum + step);
      first = sum == 0 ? 0 : first == 0 ? night : first;
    }
    if (sum <= t_.cusum) return;
    StudyFigure figure;
    figure.name = name;
    // Any session's: the alarm is of all of them.
    figure.command = list.front().last->command;
    add(figure, first, "cusum", 0, median(changes.rbegin()->second.all));
  }

  void add(const StudyFigure& f, int first, const char* kind, double was, double is) {
    alarms_.push_back({f.name, f.session, first, kind, was, is, f.command});
  }

  std::size_t window() const { return static_cast<std::size_t>(t_.window); }

  const int night_;
  const std::vector<StudyAcceptance>& accepted_;
  const RegressionThresholds& t_;
  std::map<std::string, std::vector<Series>> of_study_;
  std::vector<StudyAlarm> alarms_;
};

}  // namespace

std::vector<StudyAlarm> judgeNight(int night, const std::vector<FigureSpan>& figures,
                                   const std::vector<StudyAcceptance>& accepted,
                                   const RegressionThresholds& thresholds) {
  thresholds.check();
  return Judge(night, accepted, thresholds).judge(figures);
}

std::vector<std::string> calibratedFromOtherInputs(int night,
                                                   const std::vector<FigureSpan>& figures) {
  std::vector<std::string> sessions;
  for (const FigureSpan& last : figures) {
    const bool fails = last.figure.name == kFailedFigure && last.figure.value > 0;
    if (!fails || last.last_night != night) continue;
    bool same = false, other = false;
    for (const FigureSpan& span : figures) {
      const StudyFigure& f = span.figure;
      if (f.name != kFailedFigure || f.session != last.figure.session || f.value > 0) continue;
      (f.inputs_key == last.figure.inputs_key ? same : other) = true;
    }
    if (other && !same) sessions.push_back(last.figure.session);
  }
  return sessions;
}

}  // namespace plumbline
