// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {
namespace {

constexpr std::size_t kShortLine = 1000;  // points; below it nothing is thinned

/// Without the points that lie within a twentieth of a pixel of the last one kept.
std::vector<double> mergeEqualNeighbours(const std::vector<double>& points) {
  std::vector<double> kept;
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    const bool same = !kept.empty() && std::abs(kept[kept.size() - 2] - points[i]) < 0.05 &&
                      std::abs(kept.back() - points[i + 1]) < 0.05;
    if (same) continue;
    kept.push_back(points[i]);
    kept.push_back(points[i + 1]);
  }
  return kept;
}

/// First, lowest, highest and last point of every half pixel of width: the line looks the same. For
/// lines that never run back.
std::vector<double> keepExtremes(const std::vector<double>& points) {
  std::vector<double> kept;
  const std::size_t n = points.size() / 2;
  for (std::size_t begin = 0; begin < n;) {
    const double column = std::floor(2 * points[2 * begin]);
    std::size_t end = begin, low = begin, high = begin;
    for (; end < n && std::floor(2 * points[2 * end]) == column; ++end) {
      if (points[2 * end + 1] < points[2 * low + 1]) low = end;
      if (points[2 * end + 1] > points[2 * high + 1]) high = end;
    }
    // In the line's own order; equal ones are neighbours.
    std::vector<std::size_t> chosen = {begin, std::min(low, high), std::max(low, high), end - 1};
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const std::size_t i : chosen) {
      kept.push_back(points[2 * i]);
      kept.push_back(points[2 * i + 1]);
    }
    begin = end;
  }
  return kept;
}

}  // namespace

std::string escapeXml(const std::string& text) {
  static const std::map<char, const char*> kEntities = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    const auto entity = kEntities.find(c);
    escaped += entity == kEntities.end() ? std::string(1, c) : entity->second;
  }
  return escaped;
}

std::string pixel(double value) {
  const long tenths = std::lround(value * 10);
  if (tenths % 10 == 0) return fmt::format("{}", tenths / 10);
  // The sign apart: of -0.4 the whole part is 0, which has none.
  return fmt::format("{}{}.{}", tenths < 0 ? "-" : "", std::abs(tenths) / 10,
                     std::abs(tenths) % 10);
}

std::string finePixel(double value) {
  const long hundredths = std::lround(value * 100);
  if (hundredths % 10 == 0) return pixel(value);
  return fmt::format("{}{}.{:02}", hundredths < 0 ? "-" : "", std::abs(hundredths) / 100,
                     std::abs(hundredths) % 100);
}

std::string pointList(const std::vector<double>& points, std::string (*write)(double)) {
  std::string list;
  list.reserve(points.size() * 6);
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    if (i > 0) list += ' ';
    list += write(points[i]) + ',' + write(points[i + 1]);
  }
  return list;
}

std::vector<double> thinLine(const std::vector<double>& points) {
  if (points.size() / 2 < kShortLine) return points;
  for (std::size_t i = 2; i < points.size(); i += 2) {
    // A path that turns back passes a column more than once.
    if (points[i] < points[i - 2]) return mergeEqualNeighbours(points);
  }
  return keepExtremes(points);
}

}  // namespace plumbline::internal
