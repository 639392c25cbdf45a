// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/view_gram.h"

#include <cassert>
#include <variant>

#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/gram_kernel.h"
#include "calibrator/residuals/plain_gram.h"

namespace plumbline {
namespace {

template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void computePose(const gram::Input& in, PoseGram& out) {
  gram::writePose(gram::totalsOf(gram::sumView<W, Model, false, kRobust>(in)), out);
}

template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void computeView(const gram::Input& in, ViewGram& out) {
  const auto sums = gram::totalsOf(gram::sumView<W, Model, true, kRobust>(in));
  gram::writePose(sums, out);
  gram::writeIntrinsics<Model::kShape>(sums, out);
}

template <int W, class Model, bool kRobust>
[[gnu::always_inline]] inline void computeTarget(const gram::Input& in, TargetViewGram& out) {
  const auto sums = gram::totalsOf(gram::sumView<W, Model, true, kRobust, true>(in));
  gram::writePose(sums, out);
  gram::writeIntrinsics<Model::kShape>(sums, out);
  gram::writeTarget<Model::kShape>(sums, out);
}

// One entry per version: only these functions carry the instruction set. Lanes are the doubles of
// a register: two with SSE2, four with AVX2.
template <class Model, bool kRobust>
struct Baseline {
  static void pose(const gram::Input& in, PoseGram& out) {
    computePose<2, Model, kRobust>(in, out);
  }
  static void view(const gram::Input& in, ViewGram& out) {
    computeView<2, Model, kRobust>(in, out);
  }
  static void target(const gram::Input& in, TargetViewGram& out) {
    computeTarget<2, Model, kRobust>(in, out);
  }
  static double cost(const gram::Input& in) { return gram::costOfView<2, Model, kRobust>(in); }
};

#if defined(__x86_64__)
template <class Model, bool kRobust>
struct Avx2 {
  PLUMBLINE_AVX2 static void pose(const gram::Input& in, PoseGram& out) {
    computePose<4, Model, kRobust>(in, out);
  }
  PLUMBLINE_AVX2 static void view(const gram::Input& in, ViewGram& out) {
    computeView<4, Model, kRobust>(in, out);
  }
  PLUMBLINE_AVX2 static void target(const gram::Input& in, TargetViewGram& out) {
    computeTarget<4, Model, kRobust>(in, out);
  }
  PLUMBLINE_AVX2 static double cost(const gram::Input& in) {
    return gram::costOfView<4, Model, kRobust>(in);
  }
};
#else
template <class Model, bool kRobust>
using Avx2 = Baseline<Model, kRobust>;
#endif

/// A weight of 0 does not silence derivatives that are NaN (0 * NaN), so that such parameters do
/// not reach the kernels.
bool allFinite(const Intrinsics& camera, const Transform& T_CF) {
  return camera.projection.allFinite() && camera.distortion.allFinite() && T_CF.R.allFinite() &&
         T_CF.t.allFinite();
}

// Every used corner is charged as one that cannot be projected.
double chargeAll(const PackedView& view) { return view.used() * kInvalidSquaredError; }

/// Calls job(Version{}, input) with the version for the instruction set, the model and the loss at
/// hand, and what it reads.
template <class Job>
void dispatch(const AnyCameraModel& model, const plain::View& v, const Job& job) {
  const double cauchy_px = v.options.cauchy_px, triggs_clamp = v.options.triggs_clamp;
  assert(isAvailable(v.set));
  // With a scale of 1e-3 px and more 1 + |e|^2 / c^2 stays below 1e17, as LogSum::add() needs it.
  assert(cauchy_px == 0 || cauchy_px >= 1e-3);
  assert(triggs_clamp >= 0 && triggs_clamp <= 2);
  std::visit(
      [&]<class Model>(Model) {
        if constexpr (kIsVectorised<Model>) {
          gram::Input in = gram::viewInput(v.camera, v.T_CF, v.corners, v.options);
          in.target = v.target;
          in.triggs_clamp = triggs_clamp;
          // Without a loss the same columns serve as both factors (gram_kernel.h): a version of its
          // own.
          const bool robust = cauchy_px > 0;
          if (v.set == InstructionSet::kAvx2) {
            robust ? job(Avx2<Model, true>{}, in) : job(Avx2<Model, false>{}, in);
          } else {
            robust ? job(Baseline<Model, true>{}, in) : job(Baseline<Model, false>{}, in);
          }
        } else {
          job(plain::Version<Model>{}, v);
        }
      },
      model);
}

// For T_CF = T_CA * T_BA^-1 * T_BF, the twist of T_CF in the tangent of T_BA: the inverse turns the
// twist of T_BA, which acts in B, round, and T_CB = T_CA * T_BA^-1 carries it to C.
Matrix6d throughInverse(const Transform& T_CA, const Transform& T_BA) {
  return -adjoint(T_CA * T_BA.inverse()) * twistFromTangent(T_BA);
}

}  // namespace

bool isAvailable(InstructionSet set) {
#if defined(__x86_64__)
  static const bool kHasAvx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return set == InstructionSet::kBaseline || kHasAvx2;
#else
  return set == InstructionSet::kBaseline;
#endif
}

InstructionSet bestInstructionSet() {
  return isAvailable(InstructionSet::kAvx2) ? InstructionSet::kAvx2 : InstructionSet::kBaseline;
}

PoseGram poseGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options, InstructionSet set) {
  // Before all else: it throws for a wrong number of parameters, which what follows reads
  // unchecked.
  const AnyCameraModel model = cameraModelOf(camera);
  PoseGram out;
  if (!allFinite(camera, T_CF)) {
    out.squared_error = out.cost = chargeAll(view);
    return out;
  }
  dispatch(model, {set, camera, T_CF, view, options},
           [&](auto version, const auto& in) { version.pose(in, out); });
  return out;
}

ViewGram viewGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options, InstructionSet set) {
  const AnyCameraModel model = cameraModelOf(camera);
  ViewGram out;
  if (!allFinite(camera, T_CF)) {
    const auto K = camera.projection.size() + camera.distortion.size();
    out.H_pose_k.setZero(6, K);
    out.H_k.setZero(K, K);
    out.b_k.setZero(K);
    out.squared_error = out.cost = chargeAll(view);
    return out;
  }
  dispatch(model, {set, camera, T_CF, view, options},
           [&](auto version, const auto& in) { version.view(in, out); });
  return out;
}

TargetViewGram targetViewGram(const Intrinsics& camera, const Transform& T_CF,
                              const PackedView& view, const TargetColumns& target,
                              const GramOptions& options, InstructionSet set) {
  const AnyCameraModel model = cameraModelOf(camera);
  TargetViewGram out;
  if (!allFinite(camera, T_CF)) {
    static_cast<ViewGram&>(out) = viewGram(camera, T_CF, view, options, set);
    out.H_pose_s.setZero();
    out.H_k_s.setZero(out.b_k.size(), kTargetTerms);
    out.H_s.setZero();
    out.b_s.setZero();
    return out;
  }
  dispatch(model, {set, camera, T_CF, view, options, &target},
           [&](auto version, const auto& in) { version.target(in, out); });
  return out;
}

double viewCost(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                const GramOptions& options, InstructionSet set) {
  const AnyCameraModel model = cameraModelOf(camera);
  if (!allFinite(camera, T_CF)) return chargeAll(view);
  double cost = 0;
  dispatch(model, {set, camera, T_CF, view, options},
           [&](auto version, const auto& in) { cost = version.cost(in); });
  return cost;
}

Matrix6d adjoint(const Transform& T_AB) {
  Matrix6d Ad;
  Ad << T_AB.R, skew(T_AB.t) * T_AB.R, Eigen::Matrix3d::Zero(), T_AB.R;
  return Ad;
}

Matrix6d twistFromTangent(const Transform& T) {
  // da turns about the frame's own origin at t, phi about that of the frame it is in.
  Matrix6d A = Matrix6d::Identity();
  A.topRightCorner<3, 3>() = skew(T.t);
  return A;
}

Transform twisted(const Transform& T, const Vector6d& x) {
  const Eigen::Matrix3d turn = expSO3(x.tail<3>());
  return {Eigen::Quaterniond(turn * T.R), turn * T.t + x.head<3>()};
}

CameraImuChain cameraImuChain(const Transform& T_FS, const Transform& T_SC0,
                              const Transform& T_C0Ci) {
  const Transform T_CiC0 = T_C0Ci.inverse();
  const Transform T_CiS = T_CiC0 * T_SC0.inverse();
  // (A, B) = (S, F), (C0, S), (Ci, C0).
  CameraImuChain chain;
  chain.T_CiF = T_CiS * T_FS.inverse();
  chain.A_FS = throughInverse(T_CiS, T_FS);
  chain.A_SC0 = throughInverse(T_CiC0, T_SC0);
  chain.A_C0Ci = throughInverse(Transform(), T_C0Ci);
  return chain;
}

}  // namespace plumbline
