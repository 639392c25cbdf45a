// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/residuals/view_gram.h"

#include <cassert>
#include <variant>

#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/field_gram.h"
#include "calibrator/residuals/gram_kernel.h"
#include "calibrator/residuals/instruction_set.h"

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

gram::Input inputOf(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                    const GramOptions& options) {
  // With a scale of 1e-3 px and more 1 + |e|^2 / c^2 stays below 1e17, as LogSum::add() needs it.
  assert(options.cauchy_px == 0 || options.cauchy_px >= 1e-3);
  assert(options.triggs_clamp >= 0 && options.triggs_clamp <= 2);
  gram::Input in = gram::viewInput(camera, T_CF, view, options);
  in.triggs_clamp = options.triggs_clamp;
  return in;
}

/// A weight of 0 does not silence derivatives that are NaN (0 * NaN), so that such parameters do
/// not reach the kernels.
bool allFinite(const Intrinsics& camera, const Transform& T_CF) {
  return camera.projection.allFinite() && camera.distortion.allFinite() && T_CF.R.allFinite() &&
         T_CF.t.allFinite();
}

// Every used corner is charged as one that cannot be projected.
double chargeAll(const PackedView& view) { return view.used() * kInvalidSquaredError; }

/// Calls job(Version<Model, kRobust>{}) for the version, model and loss at hand. False, and no
/// call, for a model that the kernel is not compiled for: it goes the plain way (plain_gram.h).
template <class Job>
bool dispatch(InstructionSet set, const AnyCameraModel& model, bool robust, const Job& job) {
  assert(isAvailable(set));
  return std::visit(
      [&]<class Model>(Model) {
        if constexpr (!kIsVectorised<Model>) {
          return false;
        } else if (set == InstructionSet::kAvx2) {
          // Without a loss the same columns serve as both factors (gram_kernel.h): a version of its
          // own.
          robust ? job(Avx2<Model, true>{}) : job(Avx2<Model, false>{});
        } else {
          robust ? job(Baseline<Model, true>{}) : job(Baseline<Model, false>{});
        }
        return kIsVectorised<Model>;
      },
      model);
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

PoseGram poseGramWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                      const PackedView& view, const GramOptions& options) {
  // Before all else: it throws for a wrong number of parameters, which what follows reads
  // unchecked.
  const AnyCameraModel model = cameraModelOf(camera);
  PoseGram out;
  if (!allFinite(camera, T_CF)) {
    out.squared_error = out.cost = chargeAll(view);
    return out;
  }
  const gram::Input in = inputOf(camera, T_CF, view, options);
  const bool done =
      dispatch(set, model, options.cauchy_px > 0, [&](auto version) { version.pose(in, out); });
  if (!done) return plain::poseGram({set, model, camera, T_CF, view, options});
  return out;
}

ViewGram viewGramWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                      const PackedView& view, const GramOptions& options) {
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
  const gram::Input in = inputOf(camera, T_CF, view, options);
  const bool done =
      dispatch(set, model, options.cauchy_px > 0, [&](auto version) { version.view(in, out); });
  if (!done) return plain::viewGram({set, model, camera, T_CF, view, options});
  return out;
}

TargetViewGram targetViewGramWith(InstructionSet set, const Intrinsics& camera,
                                  const Transform& T_CF, const PackedView& view,
                                  const TargetColumns& target, const GramOptions& options) {
  const AnyCameraModel model = cameraModelOf(camera);
  TargetViewGram out;
  if (!allFinite(camera, T_CF)) {
    static_cast<ViewGram&>(out) = viewGramWith(set, camera, T_CF, view, options);
    out.H_pose_s.setZero();
    out.H_k_s.setZero(out.b_k.size(), kTargetTerms);
    out.H_s.setZero();
    out.b_s.setZero();
    return out;
  }
  gram::Input in = inputOf(camera, T_CF, view, options);
  in.target = &target;
  const bool done =
      dispatch(set, model, options.cauchy_px > 0, [&](auto version) { version.target(in, out); });
  if (!done) return plain::targetViewGram({set, model, camera, T_CF, view, options}, target);
  return out;
}

double viewCostWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                    const PackedView& view, const GramOptions& options) {
  const AnyCameraModel model = cameraModelOf(camera);
  if (!allFinite(camera, T_CF)) return chargeAll(view);
  const gram::Input in = inputOf(camera, T_CF, view, options);
  double cost = 0;
  const bool done =
      dispatch(set, model, options.cauchy_px > 0, [&](auto version) { cost = version.cost(in); });
  return done ? cost : plain::cost({set, model, camera, T_CF, view, options});
}

PoseGram poseGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options) {
  return poseGramWith(bestInstructionSet(), camera, T_CF, view, options);
}

ViewGram viewGram(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                  const GramOptions& options) {
  return viewGramWith(bestInstructionSet(), camera, T_CF, view, options);
}

TargetViewGram targetViewGram(const Intrinsics& camera, const Transform& T_CF,
                              const PackedView& view, const TargetColumns& target,
                              const GramOptions& options) {
  return targetViewGramWith(bestInstructionSet(), camera, T_CF, view, target, options);
}

double viewCost(const Intrinsics& camera, const Transform& T_CF, const PackedView& view,
                const GramOptions& options) {
  return viewCostWith(bestInstructionSet(), camera, T_CF, view, options);
}

}  // namespace plumbline
