// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/faults/fault.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

using enum FaultKind;

std::string titleOf(const Fault& fault) {
  return "fault " + (fault.spec.empty() ? std::string(describe(fault.kind).name) : fault.spec);
}

void requireWithin(const Fault& fault, const char* what, double value, const FaultValue& range) {
  if (range.quantity == Quantity::kNone) return;
  if (!(value >= range.low && value <= range.high)) {  // so that NaN fails
    throw InputError(fmt::format("{}: {} is {:.6g} {}; expected {:.6g} to {:.6g} {}",
                                 titleOf(fault), what, value, unitOf(range.quantity), range.low,
                                 range.high, unitOf(range.quantity)));
  }
  if (range.quantity == Quantity::kCount && value != std::floor(value)) {
    throw InputError(titleOf(fault) + ": expected a whole number");
  }
}

void checkKeys(const Fault& fault, const FaultScope& scope) {
  const FaultDescription& d = describe(fault.kind);
  // A stretch along z would stretch nothing.
  const int axes = fault.kind == kStretch ? 2 : 3;
  if (fault.axis && (!takesAxis(d.key) || *fault.axis < 0 || *fault.axis >= axes)) {
    throw InputError(titleOf(fault) + ": this axis does not apply to it");
  }
  if (fault.camera && !takesCamera(d.key)) {
    throw InputError(titleOf(fault) + ": it does not take a camera");
  }
  // Unnamed these concern camera 1 (view_faults.cpp), which a rig of one camera does not have.
  const bool needs_second = fault.kind == kBump || fault.kind == kExposureShift;
  const int camera = fault.camera.value_or(needs_second ? 1 : 0);
  if (takesCamera(d.key) && (camera < 0 || camera >= scope.cameras)) {
    throw InputError(fmt::format("{}: there is no cam{}; the rig has {} cameras", titleOf(fault),
                                 camera, scope.cameras));
  }
}

}  // namespace

void check(const std::vector<Fault>& faults, const FaultScope& scope) {
  for (const Fault& fault : faults) {
    const FaultDescription& d = describe(fault.kind);
    requireWithin(fault, "its value", fault.value, d.value);
    requireWithin(fault, "its second value", fault.extent, d.extent);
    checkKeys(fault, scope);
    // Later, nothing would be wrong with the recording.
    if (d.instant == TakesInstant::kYes && !(fault.at_s >= 0 && fault.at_s < scope.duration_s)) {
      throw InputError(fmt::format("{}: the recording has no time {:.6g} s; it lasts {:.6g} s",
                                   titleOf(fault), fault.at_s, scope.duration_s));
    }
  }
}

void checkRendered(const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    if (describe(fault.kind).images == InImages::kYes) continue;
    throw InputError(titleOf(fault) + ": is not simulated in images; simulate corners");
  }
}

Eigen::Vector3d direction(const Fault& fault) {
  if (fault.axis) return Eigen::Vector3d::Unit(*fault.axis);
  return Eigen::Vector3d::Constant(1 / std::sqrt(3.0));
}

RandomStream NumberedFault::random(std::uint64_t seed, std::uint64_t camera,
                                   std::uint64_t index) const {
  return {seed,
          RandomPurpose::kFault,
          {static_cast<std::uint64_t>(fault->kind), number, camera, index}};
}

std::vector<NumberedFault> faultsOf(const std::vector<Fault>& faults,
                                    std::initializer_list<FaultKind> kinds) {
  std::vector<NumberedFault> found;
  for (const Fault& fault : faults) {
    if (std::find(kinds.begin(), kinds.end(), fault.kind) == kinds.end()) continue;
    // Counted within the kind, so that faults of other kinds before it change none of its numbers.
    const auto same = std::count_if(found.begin(), found.end(), [&](const NumberedFault& other) {
      return other->kind == fault.kind;
    });
    found.push_back({&fault, static_cast<std::uint64_t>(same)});
  }
  return found;
}

}  // namespace plumbline
