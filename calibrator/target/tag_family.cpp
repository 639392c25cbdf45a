// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/tag_family.h"

#include <array>
#include <cassert>
#include <cmath>

#include <apriltag/tag36h11.h>

namespace plumbline {
namespace {

using PayloadTable = std::array<std::uint64_t, kFamilySize>;

/// The library stores a code as a sequence of bits, first bit most significant, and for each bit
/// its column and row (downwards) in the tag with its one-bit border.
std::uint64_t payloadOfCode(const apriltag_family_t& family, std::uint64_t code) {
  std::uint64_t payload = 0;
  for (std::uint32_t i = 0; i < family.nbits; ++i) {
    if ((code >> (family.nbits - 1 - i) & 1) == 0) continue;
    const auto col = static_cast<int>(family.bit_x[i]) - 1;
    const auto row_from_top = static_cast<int>(family.bit_y[i]) - 1;
    const int row = kPayloadCells - 1 - row_from_top;
    payload |= std::uint64_t{1} << (kPayloadCells * row + col);
  }
  return payload;
}

/// From the library's family as it is created: QuadFinder changes the bits' places of its own copy.
PayloadTable buildPayloads() {
  apriltag_family_t* family = tag36h11_create();
  assert(family->ncodes == kFamilySize && family->nbits == kPayloadCells * kPayloadCells);
  PayloadTable table{};
  for (std::size_t id = 0; id < table.size(); ++id) {
    table[id] = payloadOfCode(*family, family->codes[id]);
  }
  tag36h11_destroy(family);
  return table;
}

/// Where a coordinate of the plane lies along one axis of the grid.
struct AxisPosition {
  bool in_tag = false;  ///< inside the extent of tag `index`
  bool in_gap = false;  ///< inside a gap beside a tag, where the small squares are
  int index = 0;        ///< tag along this axis
  double fraction = 0;  ///< in tag: 0 at its low edge, 1 at its high edge
};

AxisPosition locateOnAxis(double coordinate, double tag_size, double gap, int tags) {
  AxisPosition at;
  const double pitch = tag_size + gap;
  const double end = pitch * (tags - 1) + tag_size;
  if (coordinate < -gap || coordinate >= end + gap) return at;
  // The gap before tag 0 counts as that of a tag -1.
  const double period = std::floor(coordinate / pitch);
  const double rest = coordinate - period * pitch;
  at.index = static_cast<int>(period);
  at.in_tag = at.index >= 0 && at.index < tags && rest < tag_size;
  at.in_gap = !at.in_tag;
  at.fraction = rest / tag_size;
  return at;
}

}  // namespace

std::uint64_t tagPayload(int tag_id) {
  static const PayloadTable table = buildPayloads();
  assert(tag_id >= 0 && tag_id < kFamilySize);
  return table[tag_id];
}

bool cellIsBlack(int tag_id, int col, int row, int border_bits) {
  assert(col >= 0 && row >= 0 && col < tagCells(border_bits) && row < tagCells(border_bits));
  const int x = col - border_bits;
  const int y = row - border_bits;
  if (x < 0 || y < 0 || x >= kPayloadCells || y >= kPayloadCells) return true;
  return (tagPayload(tag_id) >> (kPayloadCells * y + x) & 1) == 0;
}

bool gridIsBlack(const AprilGrid& grid, const Eigen::Vector2d& p_F, int border_bits) {
  const double gap = grid.spacing * grid.tag_size;
  const AxisPosition x = locateOnAxis(p_F.x(), grid.tag_size, gap, grid.cols);
  const AxisPosition y = locateOnAxis(p_F.y(), grid.tag_size, gap, grid.rows);
  // One of the small squares at the corners.
  if (x.in_gap && y.in_gap) return true;
  if (!x.in_tag || !y.in_tag) return false;
  const int cells = tagCells(border_bits);
  return cellIsBlack(y.index * grid.cols + x.index, static_cast<int>(x.fraction * cells),
                     static_cast<int>(y.fraction * cells), border_bits);
}

}  // namespace plumbline
