// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/screening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/imu_alignment.h"

namespace plumbline {
namespace {

// ---- spikes
constexpr std::size_t kReach = 2;        // samples on either side that predict a reading
constexpr double kSpikeSigmas = 12;      // a heavy tail of real noise reaches 6 to 8
constexpr double kLeastNoise = 0.3;      // of the stated white noise: densities are often padded
constexpr double kSettled = 0.15;        // of the spike, what neighbours may keep without it
constexpr std::size_t kScaleBlock = 50;  // samples over which the noise is taken, on either side
constexpr double kGaussian = 1.4826;     // standard deviation over median of |x|
// Standard deviation of d for white noise of 1: the root of 1 + (1 + 16 + 16 + 1) / 36.
constexpr double kNoiseOfDistance = 1.394;

double reading(const ImuSample& s, int channel) {
  return channel < 3 ? s.gyro(channel) : s.accel(channel - 3);
}

/// Distance from the cubic (Lagrange at equal steps) through the neighbours.
double distanceAt(const std::vector<double>& x, std::size_t k) {
  return x[k] - (4 * (x[k - 1] + x[k + 1]) - x[k - 2] - x[k + 2]) / 6;
}

/// Robust standard deviation of the distances, one for each block of samples, from the block and
/// those beside it.
std::vector<double> blockScales(const std::vector<double>& distances, double least) {
  const std::size_t blocks = distances.size() / kScaleBlock + 1;
  std::vector<double> scales;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t from = b > 0 ? (b - 1) * kScaleBlock : 0;
    const std::size_t to = std::min(distances.size(), (b + 2) * kScaleBlock);
    std::vector<double> sizes;
    for (std::size_t k = from; k < to; ++k) sizes.push_back(std::abs(distances[k]));
    scales.push_back(sizes.empty() ? least
                                   : std::max(least, kGaussian * middleOf(std::move(sizes))));
  }
  return scales;
}

/// Whether the samples around k come at equal steps, so that the cubic holds.
bool isRegular(std::span<const ImuSample> samples, std::size_t k, double interval_s) {
  for (std::size_t i = k - kReach; i < k + kReach; ++i) {
    const double step = secondsBetween(samples[i].t, samples[i + 1].t);
    if (std::abs(step - interval_s) > 0.5 * interval_s) return false;
  }
  return true;
}

/// A spike shows in the distances of its neighbours as well, by 2/3 and 1/6 of its size (the
/// weights of the cubic); the largest is itself.
bool isLargest(const std::vector<double>& distances, std::size_t k) {
  for (std::size_t i = k - kReach; i <= k + kReach; ++i) {
    if (std::abs(distances[i]) > std::abs(distances[k])) return false;
  }
  return true;
}

/// Whether the neighbours of k agree with each other once x_k is what they say. `around` holds x_k
/// in the middle with 2 kReach samples on either side. After a jump they do not.
bool settlesWithout(std::vector<double> around, double distance) {
  constexpr std::size_t kMiddle = 2 * kReach;
  around[kMiddle] -= distance;
  for (std::size_t i = kReach; i <= 3 * kReach; ++i) {
    if (std::abs(distanceAt(around, i)) > kSettled * std::abs(distance)) return false;
  }
  return true;
}

/// Where neighbours are missing, at the ends, nothing is found.
void findInChannel(std::span<const ImuSample> samples, int channel, double least, double interval_s,
                   std::vector<ImuSpike>& spikes) {
  const std::size_t n = samples.size();
  std::vector<double> x(n);
  for (std::size_t k = 0; k < n; ++k) x[k] = reading(samples[k], channel);
  std::vector<double> distances(n, 0);
  for (std::size_t k = kReach; k + kReach < n; ++k) distances[k] = distanceAt(x, k);
  const std::vector<double> scales = blockScales(distances, least);
  for (std::size_t k = 2 * kReach; k + 2 * kReach < n; ++k) {
    const double d = distances[k];
    if (std::abs(d) < kSpikeSigmas * scales[k / kScaleBlock] || !isLargest(distances, k)) continue;
    if (!isRegular(samples, k, interval_s)) continue;
    const auto first = x.begin() + static_cast<std::ptrdiff_t>(k - 2 * kReach);
    if (!settlesWithout({first, first + 4 * kReach + 1}, d)) continue;
    spikes.push_back({samples[k].t, channel, d});
  }
}

// ---- readings that are cut off
constexpr double kSame = 1e-9;             // relative: the same reading
constexpr std::size_t kFewestRepeats = 5;  // at the limit in all,
constexpr int kFewestNeighbours = 2;       // of which so many twice in a row,
constexpr std::size_t kTimesMore = 3;      // and so many times more than any
constexpr std::size_t kNextLevels = 10;    // of the next levels
constexpr std::size_t kBeside = 2;         // samples left out beside one that is cut off
constexpr double kMostCutOff = 0.4;        // of all samples

/// The largest count of equal values among the ten levels that follow the first, in descending
/// order; 0 where there are fewer.
std::size_t mostOfNextLevels(std::vector<double> sizes) {
  std::sort(sizes.rbegin(), sizes.rend());
  std::size_t most = 0;
  std::size_t count = 0;
  std::size_t level = 0;
  for (std::size_t k = 1; k < sizes.size() && level <= kNextLevels; ++k) {
    const bool same = sizes[k] >= sizes[k - 1] * (1 - kSame);
    level += same ? 0 : 1;
    count = same ? count + 1 : 1;
    if (level > 0) most = std::max(most, count);
  }
  return level >= kNextLevels ? most : 0;
}

// ---- repeated views
constexpr std::size_t kFewestCorners = 4;
constexpr double kTurned = 5e-3;          // [rad]
constexpr TimeNs kSameFrame = 5'000'000;  // [ns] between stamps of cameras

/// To the last digit: noise makes any two images of the same differ in it. Too few corners tell
/// nothing.
bool sameCorners(const ImageView& a, const ImageView& b) {
  if (a.corners.size() < kFewestCorners || a.corners.size() != b.corners.size()) return false;
  return std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(),
                    [](const Corner& p, const Corner& q) { return p.id == q.id && p.uv == q.uv; });
}

/// Whether another camera saw something else at the two instants.
bool anotherChanged(const Session& session, std::size_t camera, TimeNs from, TimeNs to) {
  const auto viewAt = [](const CameraStream& stream, TimeNs t) -> const ImageView* {
    const auto at = std::ranges::lower_bound(stream.views, t - kSameFrame, {}, &ImageView::t);
    return at != stream.views.end() && at->t <= t + kSameFrame ? &*at : nullptr;
  };
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    if (c == camera) continue;
    const ImageView* before = viewAt(session.cameras[c], from);
    const ImageView* after = viewAt(session.cameras[c], to);
    if (before == nullptr || after == nullptr) continue;
    if (after->corners.size() >= kFewestCorners && !sameCorners(*before, *after)) return true;
  }
  return false;
}

// ---- tags
constexpr double kOffPlace = 0.5;       // of a tag's side
constexpr double kInPlace = 0.25;       // likewise
constexpr double kMostMisplaced = 0.4;  // of a view's tags
constexpr int kFewestOfTag = 3;         // corners

/// Largest distance of a tag's corners from where the pose puts those of another tag [px].
double distanceFromPlace(const AprilGrid& target, const Intrinsics& camera, const PackedView& view,
                         const std::vector<int>& corners, int place, const Transform& T_CF) {
  double worst = 0;
  for (const int k : corners) {
    const Eigen::Vector2d p = target.corner(4 * place + view.id[k] % 4);
    const auto uv = project(camera, T_CF * Eigen::Vector3d(p.x(), p.y(), 0));
    if (!uv) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, (*uv - Eigen::Vector2d(view.u[k], view.v[k])).norm());
  }
  return worst;
}

/// Distances of a view's corners from the pose's prediction; infinite where there is none.
std::vector<double> distancesOf(const Intrinsics& camera, const PackedView& view,
                                const Transform& T_CF) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(view.count));
  for (int k = 0; k < view.count; ++k) {
    points.push_back(T_CF * Eigen::Vector3d(view.x[k], view.y[k], view.z[k]));
  }
  const auto projected = project(camera, points);
  std::vector<double> out(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (projected[k]) out[k] = (*projected[k] - Eigen::Vector2d(view.u[k], view.v[k])).norm();
  }
  return out;
}

/// The shortest side that is seen of a tag [px], of those between corners that follow each other;
/// infinite where none is seen.
double sideOf(const PackedView& view, const std::vector<int>& corners) {
  double side = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const int a = corners[i];
    const int b = corners[i + 1];
    if (view.id[b] != view.id[a] + 1) continue;
    side = std::min(side, std::hypot(view.u[a] - view.u[b], view.v[a] - view.v[b]));
  }
  return side;
}

}  // namespace

std::vector<ImuSpike> findSpikes(std::span<const ImuSample> samples, const ImuNoise& noise) {
  std::vector<ImuSpike> spikes;
  if (samples.size() < 4 * kReach + 1) return spikes;
  const double interval_s = medianSampleInterval(samples);
  const double root_rate = std::sqrt(1 / interval_s);
  for (int channel = 0; channel < 6; ++channel) {
    const double density = channel < 3 ? noise.gyro_density : noise.accel_density;
    // Discrete noise of a density is density * sqrt(rate).
    findInChannel(samples, channel, kLeastNoise * kNoiseOfDistance * density * root_rate,
                  interval_s, spikes);
  }
  std::ranges::sort(spikes, {}, [](const ImuSpike& s) { return std::pair(s.t, s.channel); });
  return spikes;
}

std::vector<ImuSample> withoutSpikes(std::span<const ImuSample> samples,
                                     std::span<const ImuSpike> spikes) {
  std::vector<ImuSample> out;
  out.reserve(samples.size());
  auto spike = spikes.begin();
  for (const ImuSample& s : samples) {
    while (spike != spikes.end() && spike->t < s.t) ++spike;
    if (spike == spikes.end() || spike->t != s.t) out.push_back(s);
  }
  return out;
}

std::vector<CutOff> findCutOff(std::span<const ImuSample> samples) {
  std::vector<CutOff> out;
  for (int channel = 0; channel < 6 && !samples.empty(); ++channel) {
    std::vector<double> sizes;
    for (const ImuSample& s : samples) sizes.push_back(std::abs(reading(s, channel)));
    CutOff found{channel, *std::max_element(sizes.begin(), sizes.end()), {}};
    int neighbours = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      if (sizes[k] < found.limit * (1 - kSame)) continue;
      if (!found.samples.empty() && found.samples.back() + 1 == k) ++neighbours;
      found.samples.push_back(k);
    }
    // 0: a channel that is dead, or rests on one of few levels.
    const std::size_t below = mostOfNextLevels(std::move(sizes));
    if (found.samples.size() >= kFewestRepeats && neighbours >= kFewestNeighbours && below > 0 &&
        found.samples.size() > kTimesMore * below) {
      out.push_back(std::move(found));
    }
  }
  return out;
}

std::vector<ImuSample> withoutCutOff(std::span<const ImuSample> samples,
                                     std::span<const CutOff> cut_off) {
  std::vector<bool> keep(samples.size(), true);
  for (const CutOff& channel : cut_off) {
    for (const std::size_t k : channel.samples) {
      const std::size_t last = std::min(k + kBeside, samples.size() - 1);
      for (std::size_t i = k > kBeside ? k - kBeside : 0; i <= last; ++i) keep[i] = false;
    }
  }
  // One sample and kBeside on either side leave a step of six intervals, more than the
  // kGapIntervals (5) that count as none. Fewer, and the integral would go straight through what
  // was cut off.
  const auto left_out = static_cast<double>(std::count(keep.begin(), keep.end(), false));
  const bool too_many = left_out >= kMostCutOff * static_cast<double>(samples.size());
  std::vector<ImuSample> out;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (keep[k] || too_many) out.push_back(samples[k]);
  }
  return out;
}

std::vector<std::vector<int>> repeatedViews(const Session& session) {
  std::vector<std::vector<int>> repeated(session.cameras.size());
  std::optional<GyroIntegral> gyro;
  if (session.imu && session.imu->samples.size() > 1) gyro.emplace(session.imu->samples);
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const std::vector<ImageView>& views = session.cameras[c].views;
    for (std::size_t k = 1; k < views.size(); ++k) {
      if (!sameCorners(views[k - 1], views[k])) continue;
      const TimeNs from = views[k - 1].t;
      const TimeNs to = views[k].t;
      // Under no offset of the clocks, which is not known yet.
      const auto rate = gyro ? gyro->meanRate(from, to, 0) : std::nullopt;
      const bool turned = rate && rate->norm() * secondsBetween(from, to) > kTurned;
      if (turned || anotherChanged(session, c, from, to)) {
        repeated[c].push_back(static_cast<int>(k));
      }
    }
  }
  return repeated;
}

std::vector<int> cornersOfTag(const PackedView& view, int tag) {
  const int* first = std::lower_bound(view.id, view.id + view.count, 4 * tag);
  std::vector<int> positions;
  for (const int* id = first; id != view.id + view.count && *id / 4 == tag; ++id) {
    positions.push_back(static_cast<int>(id - view.id));
  }
  return positions;
}

std::vector<MisplacedTag> findMisplacedTags(const AprilGrid& target, const Intrinsics& camera,
                                            const PackedView& view, const Transform& T_CF) {
  const std::vector<double> distances = distancesOf(camera, view, T_CF);
  std::vector<MisplacedTag> misplaced;
  int tags = 0;
  int off_place = 0;
  for (int begin = 0; begin < view.count;) {
    const int tag = view.id[begin] / 4;
    const std::vector<int> corners = cornersOfTag(view, tag);
    begin += static_cast<int>(corners.size());
    if (static_cast<int>(corners.size()) < kFewestOfTag) continue;
    ++tags;
    const double side = sideOf(view, corners);
    const bool off = std::all_of(corners.begin(), corners.end(), [&](int k) {
      return distances[static_cast<std::size_t>(k)] > kOffPlace * side;
    });
    if (!off) continue;
    MisplacedTag found{.tag = tag, .place = tag};
    // Another place must be nearer than a quarter of a side; otherwise the tag is off, but not
    // misplaced.
    double nearest = kInPlace * side;
    for (int place = 0; place < target.tagCount(); ++place) {
      const double d = distanceFromPlace(target, camera, view, corners, place, T_CF);
      if (!(d < nearest)) continue;
      nearest = d;
      found.place = place;
    }
    ++off_place;
    if (found.place != tag) misplaced.push_back(found);
  }
  if (static_cast<double>(off_place) >= kMostMisplaced * tags) return {};
  return misplaced;
}

std::vector<int> beyondAngle(const PackedView& view, const Transform& T_CF, double angle_rad) {
  const double least = std::cos(angle_rad);
  std::vector<int> positions;
  for (int k = 0; k < view.count; ++k) {
    if (!(view.w[k] > 0)) continue;
    const Eigen::Vector3d p = T_CF * Eigen::Vector3d(view.x[k], view.y[k], view.z[k]);
    // z < least |p| without a root, whatever the signs.
    const double squares = p.z() * std::abs(p.z()) - least * std::abs(least) * p.squaredNorm();
    if (squares < 0) positions.push_back(k);
  }
  return positions;
}

std::vector<int> falseCorners(const Intrinsics& camera, const PackedView& view,
                              const Transform& T_CF) {
  constexpr double kLeast = 3;  // [px]
  constexpr double kSigmas = 8;
  const std::vector<double> distances = distancesOf(camera, view, T_CF);
  std::vector<double> used;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0) used.push_back(distances[static_cast<std::size_t>(k)]);
  }
  // Most views have none that far off, whatever their median.
  if (used.empty() || *std::max_element(used.begin(), used.end()) <= kLeast) return {};
  // The distance of two Gaussian coordinates is Rayleigh's, whose median is 1.18 deviations of an
  // axis: a deviation that a few false corners do not move.
  const double limit = std::max(kLeast, kSigmas * middleOf(std::move(used)) / kRayleighMedian);
  std::vector<int> out;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0 && distances[static_cast<std::size_t>(k)] > limit) out.push_back(k);
  }
  return out;
}

}  // namespace plumbline
