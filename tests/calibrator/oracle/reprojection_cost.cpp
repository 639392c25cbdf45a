// SPDX-License-Identifier: BSD-3-Clause
#include "tests/calibrator/oracle/reprojection_cost.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/product_manifold.h>

#include "calibrator/camera/camera_dispatch.h"

namespace plumbline {
namespace {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// T^-1 * p for a pose block.
template <class T>
Vector3<T> throughInverse(const T* block, const Vector3<T>& p) {
  const Eigen::Map<const Vector3<T>> t(block);
  const Eigen::Map<const Eigen::Quaternion<T>> q(block + 3);
  return q.conjugate() * Vector3<T>(p - t);
}

template <CameraModel Model>
struct Reprojection {
  CornerMeasurement corner;

  template <class T>
  bool operator()(const T* intrinsics, const T* T_C0Ci, const T* T_FC0, T* e) const {
    return projectInto<T>(intrinsics, T_C0Ci, throughInverse<T>(T_FC0, p_F<T>()), e);
  }

  template <class T>
  bool operator()(const T* intrinsics, const T* T_C0Ci, const T* T_SC0, const T* T_FS, T* e) const {
    const Vector3<T> p_S = throughInverse<T>(T_FS, p_F<T>());
    return projectInto<T>(intrinsics, T_C0Ci, throughInverse<T>(T_SC0, p_S), e);
  }

 private:
  template <class T>
  Vector3<T> p_F() const {
    return {T(corner.p_F.x()), T(corner.p_F.y()), T(0)};
  }

  template <class T>
  bool projectInto(const T* intrinsics, const T* T_C0Ci, const Vector3<T>& p_C0, T* e) const {
    const Vector3<T> p_C = throughInverse<T>(T_C0Ci, p_C0);
    std::array<T, CameraValues::kMostShape> k;
    for (int i = 0; i < Model::kShape; ++i) {
      k[static_cast<std::size_t>(i)] = intrinsics[shapeColumn<Model>(i)];
    }
    if (!Model::isProjectable(k.data(), p_C.x(), p_C.y(), p_C.z())) return false;
    const auto m = Model::image(k.data(), p_C.x(), p_C.y(), p_C.z());
    const T* lens = intrinsics + Model::kLeading;  // fu fv pu pv
    e[0] = lens[0] * m.x + lens[2] - corner.uv.x();
    e[1] = lens[1] * m.y + lens[3] - corner.uv.y();
    return true;
  }
};

// Those of the simulated rigs with two cameras: each costs seconds to compile.
template <class Model>
constexpr bool kHasOracle =
    std::is_same_v<Model, PinholeRadtan> || std::is_same_v<Model, PinholeEquidistant>;

// The functor of the camera's model as a cost function; kPoses: sizes of the pose blocks.
template <int... kPoses>
std::unique_ptr<ceres::CostFunction> makeCost(const Intrinsics& camera,
                                              const CornerMeasurement& corner) {
  return std::visit(
      [&]<class Model>(Model) -> std::unique_ptr<ceres::CostFunction> {
        if constexpr (kHasOracle<Model>) {
          using Functor = Reprojection<Model>;
          constexpr int kIntrinsics = 4 + Model::kShape;
          return std::make_unique<ceres::AutoDiffCostFunction<Functor, 2, kIntrinsics, kPoses...>>(
              new Functor{corner});
        } else {
          throw std::invalid_argument("add this lens model to kHasOracle");
        }
      },
      cameraModelOf(camera));
}

}  // namespace

PoseBlock poseBlockFrom(const Transform& T) {
  PoseBlock block;
  Eigen::Map<Eigen::Vector3d>(block.data()) = T.t;
  Eigen::Map<Eigen::Quaterniond>(block.data() + 3) = T.quaternion();
  return block;
}

Transform transformFrom(const PoseBlock& block) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Quaterniond>(block.data() + 3)),
          Eigen::Map<const Eigen::Vector3d>(block.data())};
}

std::unique_ptr<ceres::Manifold> makePoseManifold() {
  return std::make_unique<
      ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>>();
}

std::unique_ptr<ceres::CostFunction> makeReprojectionCost(const Intrinsics& camera,
                                                          const CornerMeasurement& corner) {
  return makeCost<7, 7>(camera, corner);
}

std::unique_ptr<ceres::CostFunction> makeImuReprojectionCost(const Intrinsics& camera,
                                                             const CornerMeasurement& corner) {
  return makeCost<7, 7, 7>(camera, corner);
}

}  // namespace plumbline
