// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/paired_prediction.h"

#include <cmath>
#include <map>
#include <utility>

namespace plumbline {
namespace {

constexpr std::size_t kBlock = 10;  // views
constexpr std::size_t kFewestBlocks = 5;

struct SquaredErrors {
  double sum = 0;
  int corners = 0;
  double mean() const { return sum / corners; }
};

/// By camera and index of the view in its stream, which both results share.
using ViewErrors = std::map<std::pair<int, int>, SquaredErrors>;

ViewErrors viewErrors(const CameraStageResult& result) {
  ViewErrors views;
  for (const CornerResidual& r : result.residuals) {
    if (!r.used) continue;
    const Frame& frame = result.frames[static_cast<std::size_t>(r.frame)];
    SquaredErrors& view = views[{r.camera, frame.view[static_cast<std::size_t>(r.camera)]}];
    view.sum += static_cast<double>(r.error.squaredNorm());
    ++view.corners;
  }
  return views;
}

double meanOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double standardError(const std::vector<double>& values) {
  const double mean = meanOf(values);
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1) / n);
}

std::vector<double> blockMeans(const std::vector<double>& values) {
  std::vector<double> means;
  for (std::size_t at = 0; at + kBlock <= values.size(); at += kBlock) {
    means.push_back(meanOf({values.begin() + static_cast<std::ptrdiff_t>(at),
                            values.begin() + static_cast<std::ptrdiff_t>(at + kBlock)}));
  }
  return means;
}

}  // namespace

std::vector<PairedPrediction> pairedPredictions(const CameraStageResult& first,
                                                const CameraStageResult& other,
                                                const std::string& label) {
  const ViewErrors before = viewErrors(first);
  std::map<int, std::vector<double>> differences;
  for (const auto& [view, errors] : viewErrors(other)) {
    const auto found = before.find(view);
    if (found == before.end()) continue;
    differences[view.first].push_back(errors.mean() - found->second.mean());
  }
  std::vector<PairedPrediction> out;
  for (const auto& [camera, values] : differences) {
    if (values.size() < 2) continue;
    const std::vector<double> blocks = blockMeans(values);
    PairedPrediction p;
    p.label = label;
    p.camera = other.cameras[static_cast<std::size_t>(camera)].name;
    p.views = static_cast<int>(values.size());
    p.difference_px2 = meanOf(values);
    p.std_px2 = standardError(blocks.size() < kFewestBlocks ? values : blocks);
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace plumbline
