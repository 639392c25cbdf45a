// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/corners.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "datasets/files/table.h"
#include "datasets/session/stamps.h"

namespace plumbline {
namespace {

constexpr const char* kCornersLayout = "timestamp [ns], corner_id, u [px], v [px]";

// Turns rows into views; a view's corners gather in one buffer, so that each is allocated once.
class ViewBuilder {
 public:
  // Views count from 1, so that -1 is an id that none has shown yet.
  ViewBuilder(TextTable& table, const CornerLimits& limits)
      : table_(table),
        limits_(limits),
        last_seen_(static_cast<std::size_t>(limits.corner_count), -1) {}

  void addRow() {
    const TimeNs t = table_.stamp();
    // The first stamp may be 0, as t_ is before it.
    if (t != t_ || views_seen_ == 0) startView(t);
    Corner corner;
    corner.id = table_.integer(limits_.of_tracks ? "track_id" : "corner_id");
    checkId(corner.id);
    corner.uv.x() = table_.number("u [px]");
    corner.uv.y() = table_.number("v [px]");
    table_.endRow();
    checkInside(corner.uv);
    sorted_ = sorted_ && (corners_.empty() || corners_.back().id < corner.id);
    corners_.push_back(corner);
  }

  std::vector<ImageView> finish() {
    closeView();
    return std::move(views_);
  }

 private:
  void startView(TimeNs t) {
    if (views_seen_ > 0 && t < t_) {
      throw table_.fault({InputFault::kBadOrder,
                          fmt::format("the stamp {} is earlier than {} above it", t, t_),
                          "frames that ascend in time, the rows of a frame together",
                          "sort the rows by time (sort -t, -k1,1n -k2,2n)"});
    }
    closeView();
    t_ = t;
    ++views_seen_;
  }

  void closeView() {
    if (views_seen_ == 0) return;
    // Rows of a frame may come in any order; in a view ids ascend.
    if (!sorted_) std::ranges::sort(corners_, {}, &Corner::id);
    views_.push_back({t_, corners_});
    corners_.clear();
    sorted_ = true;
  }

  void checkId(int id) {
    const bool known = id >= 0 && id < limits_.corner_count;
    if (!known && limits_.of_tracks) {
      throw table_.fault(
          {InputFault::kOutOfRange,
           fmt::format("track_id {} is not between 0 and {}", id, limits_.corner_count - 1),
           "tracks counted from 0", "renumber them"});
    }
    if (!known) {
      throw table_.fault({InputFault::kOutOfRange,
                          fmt::format("corner_id {} is not on the target", id),
                          fmt::format("4 * tag + corner, from 0 to {}", limits_.corner_count - 1),
                          "is target.yaml that of this recording (tagRows, tagCols)?"});
    }
    int& seen = last_seen_[static_cast<std::size_t>(id)];
    if (seen == views_seen_) {
      throw table_.fault({InputFault::kDuplicate,
                          fmt::format("the id {} is given twice for the stamp {}", id, t_),
                          "each point once in a frame", duplicateCure(t_)});
    }
    seen = views_seen_;
  }

  void checkInside(const Eigen::Vector2d& uv) const {
    const Resolution& size = limits_.resolution;
    // Pixels reach half a pixel around their centres, the first centre being (0, 0).
    if (uv.x() >= -0.5 && uv.y() >= -0.5 && uv.x() <= size.width - 0.5 &&
        uv.y() <= size.height - 0.5) {
      return;
    }
    throw table_.fault(
        {InputFault::kOutOfRange,
         fmt::format("the corner ({:g}, {:g}) lies outside the image", uv.x(), uv.y()),
         fmt::format("a position within {} x {} pixels", size.width, size.height),
         "is the resolution in sensor.yaml (or by option) that of this camera?"});
  }

  TextTable& table_;
  const CornerLimits& limits_;
  std::vector<int> last_seen_;  // of each id: the view in which it came last
  std::vector<ImageView> views_;
  std::vector<Corner> corners_;
  TimeNs t_ = 0;
  int views_seen_ = 0;
  bool sorted_ = true;
};

}  // namespace

std::vector<ImageView> readCorners(const std::string& path, const CornerLimits& limits) {
  using NoRows = TextTable::NoRows;
  const MappedFile file(path);
  TextTable table(path, file.text(), kCornersLayout);
  table.readHeader(limits.may_be_empty ? NoRows::kAccept : NoRows::kRefuse);
  ViewBuilder builder(table, limits);
  while (table.nextRow()) builder.addRow();
  std::vector<ImageView> views = builder.finish();
  checkStampUnit(path, intervalsOf(views), kShortestFrameInterval, "frames");
  return views;
}

}  // namespace plumbline
