// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/packed_corners.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const AprilGrid kPackedTarget;

std::vector<ImageView> viewsOf(const std::vector<int>& counts) {
  std::vector<ImageView> views;
  for (int count : counts) {
    ImageView view;
    for (int i = 0; i < count; ++i) view.corners.push_back({i + 1, {10.5 + i, 20.25 - i}});
    views.push_back(view);
  }
  return views;
}

void expectHolds(const PackedView& packed, const ImageView& view) {
  ASSERT_EQ(packed.count, static_cast<int>(view.corners.size()));
  EXPECT_EQ(packed.padded % kLanes, 0);
  EXPECT_GE(packed.padded, packed.count);
  EXPECT_LT(packed.padded, packed.count + kLanes);
  for (int i = 0; i < packed.count; ++i) {
    const Corner& corner = view.corners[i];
    EXPECT_EQ(packed.id[i], corner.id);
    EXPECT_EQ(packed.x[i], kPackedTarget.corner(corner.id).x());
    EXPECT_EQ(packed.y[i], kPackedTarget.corner(corner.id).y());
    EXPECT_EQ(packed.u[i], corner.uv.x());
    EXPECT_EQ(packed.v[i], corner.uv.y());
    EXPECT_EQ(packed.w[i], 1);
  }
  for (int i = packed.count; i < packed.padded; ++i) {
    EXPECT_EQ(packed.w[i], 0);
    EXPECT_EQ(packed.u[i], packed.u[packed.count - 1]);
  }
}

TEST(PackedCorners, HoldsEveryViewPaddedWithItsLastCorner) {
  const std::vector<ImageView> views = viewsOf({1, 8, 0, 9, 143});
  const PackedCorners corners(kPackedTarget, views);
  ASSERT_EQ(corners.viewCount(), 5);
  for (int i = 0; i < 5; ++i) expectHolds(corners.view(i), views[i]);
}

TEST(PackedCorners, AThinnedCopyHasCornersEvenlyInTheirOrder) {
  const std::vector<ImageView> views = viewsOf({9, 143, 0, 20});
  const PackedCorners few = PackedCorners(kPackedTarget, views).thinned({3, 1, 2}, 10);
  ASSERT_EQ(few.viewCount(), 3);
  ImageView every_second, tenth;
  for (int i = 0; i < 10; ++i) {
    every_second.corners.push_back(views[3].corners[2 * i]);
    tenth.corners.push_back(views[1].corners[143 * i / 10]);
  }
  expectHolds(few.view(0), every_second);
  expectHolds(few.view(1), tenth);
  EXPECT_EQ(few.view(2).count, 0);
}

TEST(PackedCorners, ColumnsAreAlignedInTheOriginalAndInCopies) {
  const std::vector<ImageView> views = viewsOf({3, 17, 8});
  const PackedCorners original(kPackedTarget, views);
  const PackedCorners copy = original;
  for (const PackedCorners* corners : {&original, &copy}) {
    for (int i = 0; i < 3; ++i) {
      const PackedView view = corners->view(i);
      for (const double* column : {view.x, view.y, view.u, view.v, view.w}) {
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(column) % 64, 0U);
      }
      expectHolds(view, views[i]);
    }
  }
}

TEST(PackedCorners, AWeightBelongsToOneCornerOfOneView) {
  PackedCorners corners(kPackedTarget, viewsOf({10, 12}));
  corners.setWeight(1, 9, 0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(corners.view(0).w[i], 1);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(corners.view(1).w[i], i == 9 ? 0 : 1);
  corners.setWeight(1, 9, 1);
  EXPECT_EQ(corners.view(1).w[9], 1);
}

// A detector errs by pixels: half as large tags look wider by twice as much of the board.
TEST(PackedCorners, TheTagsEdgesDependOnTheirSizeInTheImage) {
  AprilGrid board;
  board.shape.terms[kTargetTerms - 1] = 1e-3;
  const auto square = [](double edge_px, int count) {
    ImageView view;
    const Eigen::Vector2d corner[] = {{0, edge_px}, {edge_px, edge_px}, {edge_px, 0}, {0, 0}};
    for (int k = 0; k < count; ++k) view.corners.push_back({k, corner[k]});
    return view;
  };
  PackedCorners corners(board, {square(kTagEdgePx, 4), square(kTagEdgePx / 2, 4),
                                square(2 * kTagEdgePx, 2), square(1, 4), square(1, 1)});
  const double scale[] = {1, 2, 0.5, 10, 1};  // a tag of 1 px is none, a single corner says nothing
  for (int pass = 0; pass < 2; ++pass, corners.place(board)) {
    for (int i = 0; i < 5; ++i) {
      const PackedView view = corners.view(i);
      EXPECT_DOUBLE_EQ(view.edge[0], scale[i]);
      EXPECT_NEAR(view.x[0], -0.5e-3 * scale[i], 1e-15);
      EXPECT_NEAR(view.y[0], -0.5e-3 * scale[i], 1e-15);
      if (view.count < 2) continue;
      EXPECT_NEAR(view.x[1], board.tag_size + 0.5e-3 * scale[i], 1e-15);
    }
  }
}

// Seen from the side a tag's edges differ: the mean of those that are seen counts. A tag of which
// no edge is seen is as large as the others of its view.
TEST(PackedCorners, ATagIsAsWideAsItsEdgesInTheMean) {
  AprilGrid board;
  board.shape.terms[kTargetTerms - 1] = 1e-3;
  const double e = kTagEdgePx;
  ImageView view;
  view.corners = {{0, {0, 0}}, {1, {e, 0}}, {2, {e, 2 * e}}, {3, {0, 5 * e}}};  // e, 2 e, ., 5 e
  view.corners.push_back({9, {9 * e, 0}});
  const double mean = (1 + 2 + std::sqrt(10) + 5) / 4;
  const PackedCorners corners(board, {view});
  EXPECT_NEAR(corners.view(0).edge[0], 1 / mean, 1e-12);
  EXPECT_NEAR(corners.view(0).edge[4], 1 / mean, 1e-12);
  view.corners.erase(view.corners.begin());  // 2 e and sqrt(10) e are left
  const PackedCorners three(board, {view});
  EXPECT_NEAR(three.view(0).edge[0], 2 / (2 + std::sqrt(10)), 1e-12);
}

TEST(PackedCorners, MayBeEmpty) {
  EXPECT_EQ(PackedCorners().viewCount(), 0);
  const PackedCorners none(kPackedTarget, viewsOf({0}));
  EXPECT_EQ(none.view(0).count, 0);
  EXPECT_EQ(none.view(0).padded, 0);
}

}  // namespace
}  // namespace plumbline
