// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/kalibr/camchain.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_fields.h"
#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

using Part = Implausible::Part;

// Kalibr writes every digit of both transforms, and they agree to rounding; the room is for files
// whose numbers were shortened on the way.
constexpr double kTranslation = 1e-3;  // [m] up to which transforms agree
constexpr double kRotation = 0.1 * kDegree;

/// T_CiS as Kalibr writes it, or its inverse as OpenVINS does: the key that is there.
const char* imuKey(const YamlMap& map) { return map.has("T_cam_imu") ? "T_cam_imu" : "T_imu_cam"; }

// Said by a word; line_delay, a number, is judged by who uses the chain.
void refuseRollingShutter(const YamlMap& map) {
  if (!map.isTrue("rolling_shutter")) return;
  throw map.fault("rolling_shutter",
                  {InputFault::kUnsupported, "a rolling shutter", "a global shutter",
                   "rolling shutters are not supported yet"});
}

// Translation and rotation each by itself: no one number weighs metres against radians.
bool agree(const Transform& a, const Transform& b) {
  const Vector6d d = boxminus(a, b);
  return d.head<3>().norm() <= kTranslation && d.tail<3>().norm() <= kRotation;
}

/// T_CiS by either key; where both are there, they must be each other's inverse.
std::optional<Transform> imuPlace(const YamlMap& map) {
  std::optional<Transform> T_CiS;
  if (map.has("T_cam_imu")) T_CiS = transformField(map, "T_cam_imu");
  if (!map.has("T_imu_cam")) return T_CiS;
  const Transform inverse = transformField(map, "T_imu_cam").inverse();
  if (!T_CiS) return inverse;
  if (agree(*T_CiS, inverse)) return T_CiS;
  throw map.fault("T_imu_cam", {InputFault::kContradiction,
                                "T_imu_cam is not the inverse of the T_cam_imu beside it",
                                "one of them, or both of one calibration", "delete the wrong one"});
}

KalibrCamera cameraOf(const YamlMap& map, const std::string& name) {
  KalibrCamera camera;
  camera.stated.emplace(map);
  camera.name = name;
  camera.rostopic = map.textOr("rostopic", "");
  camera.intrinsics = intrinsicsField(map, {"camera_model", "distortion_model"});
  camera.T_cam_imu = imuPlace(map);
  if (map.has("T_cn_cnm1")) camera.T_cn_cnm1 = transformField(map, "T_cn_cnm1");
  if (map.has("timeshift_cam_imu")) {
    camera.timeshift_cam_imu = map.number("timeshift_cam_imu", "seconds");
  }
  if (map.has("line_delay")) camera.line_delay_s = map.number("line_delay", "seconds a row");
  // As if it were the rig's IMU, to be judged by the rules of one.
  const double shift = camera.timeshift_cam_imu.value_or(0);
  ImuCalibration imu;
  imu.time_offsets = {{shift}};
  if (camera.T_cam_imu) imu.T_SC0 = camera.T_cam_imu->inverse();
  refuseImplausible(map, implausible(imu),
                    {{Part::kOffset, "timeshift_cam_imu"}, {Part::kPlace, imuKey(map)}});
  refuseRollingShutter(map);
  return camera;
}

std::string suspectText(ChainContradiction::Suspect suspect, const KalibrCamera& camera,
                        const KalibrCamera& previous) {
  using Suspect = ChainContradiction::Suspect;
  const std::string imu = "T_cam_imu is inverted (it must map IMU to camera): invert it";
  switch (suspect) {
    case Suspect::kChain:
      return fmt::format(
          "{}'s T_cn_cnm1 is inverted (it must map the previous camera to this one): invert it",
          camera.name);
    case Suspect::kThisCamera:
      return fmt::format("{}'s {}", camera.name, imu);
    case Suspect::kPreviousCamera:
      return fmt::format("{}'s {}", previous.name, imu);
    case Suspect::kAllCameras:
      return fmt::format("every camera's {}", imu);
    case Suspect::kNone:
      break;
  }
  return "one of them may be from another calibration";
}

BadInput contradictionFault(const KalibrCamchain& chain, std::size_t i,
                            const ChainContradiction& found) {
  const bool by_chain = found.suspect == ChainContradiction::Suspect::kChain;
  const KalibrCamera& camera = chain.cameras[i];
  return camera.stated->fault(
      by_chain ? "T_cn_cnm1" : imuKey(*camera.stated),
      {InputFault::kContradiction,
       fmt::format("T_cam_imu and T_cn_cnm1 contradict each other by {:.1f} mm and {:.2f} degrees",
                   1e3 * found.translation_m, found.rotation_rad / kDegree),
       "T_cam_imu mapping IMU to camera, T_cn_cnm1 the previous camera to this one",
       suspectText(found.suspect, camera, chain.cameras[i - 1])});
}

bool hasImuPlace(const KalibrCamera& camera) { return camera.T_cam_imu.has_value(); }
bool hasTimeShift(const KalibrCamera& camera) { return camera.timeshift_cam_imu.has_value(); }

// T_C0Ci from the chain; where the chain does not say, by the T_cam_imu of this camera and of one
// before it.
Transform placeInRig(const KalibrCamchain& chain, std::size_t i, const Calibration& so_far) {
  if (i == 0) return {};
  const KalibrCamera& camera = chain.cameras[i];
  // T_C0Ci = T_C0C(i-1) T_CiC(i-1)^-1, along the chain.
  if (camera.T_cn_cnm1) return so_far.cameras.back().T_C0Ci * camera.T_cn_cnm1->inverse();
  if (!camera.T_cam_imu) {
    throw badInput(chain.path, camera.stated->line(),
                   {InputFault::kMissingKey, "neither T_cn_cnm1 nor T_cam_imu is given",
                    kMatrixRows, "without one of them this camera's place is unknown"});
  }
  const auto other = std::ranges::find_if(chain.cameras, hasImuPlace);
  const auto j = static_cast<std::size_t>(other - chain.cameras.begin());
  // T_C0Ci = T_C0Cj T_CjS T_CiS^-1.
  if (j < i) return so_far.cameras[j].T_C0Ci * *other->T_cam_imu * camera.T_cam_imu->inverse();
  const char* const key = imuKey(*camera.stated);
  throw badInput(chain.path, camera.stated->line(),
                 {InputFault::kMissingKey,
                  fmt::format("{} is given without T_cn_cnm1, and no camera before has one", key),
                  fmt::format("T_cn_cnm1, or {} of cam0 as well", key),
                  "without one of them this camera's place is unknown"});
}

// Kalibr's file states links between neighbours; a place that is too far shows when they are
// joined.
void refuseFarPlace(const YamlMap& stated, const CameraCalibration& camera) {
  const auto found = implausible(camera);
  if (!found) return;
  throw stated.fault(stated.has("T_cn_cnm1") ? "T_cn_cnm1" : imuKey(stated),
                     found->complaint("correct the transforms of the cameras up to this one"));
}

// A camera without a shift of its own takes that of the first camera that has one. The file does
// not say which shifts were estimated: those that differ were.
TimeOffsets offsetsOf(const KalibrCamchain& chain) {
  const auto first = std::ranges::find_if(chain.cameras, hasTimeShift);
  const double otherwise = first == chain.cameras.end() ? 0 : *first->timeshift_cam_imu;
  TimeOffsets offsets;
  for (const KalibrCamera& c : chain.cameras) {
    const double shift = c.timeshift_cam_imu.value_or(otherwise);
    offsets.push_back({shift, !offsets.empty() && shift != offsets.front().s});
  }
  return offsets;
}

ImuCalibration imuOf(const KalibrCamchain& chain, const Calibration& cameras) {
  ImuCalibration imu;
  const auto first = std::ranges::find_if(chain.cameras, hasImuPlace);
  imu.T_SC0 = first->T_cam_imu->inverse();
  // T_SC0 = T_SCi T_C0Ci^-1.
  const auto i = static_cast<std::size_t>(first - chain.cameras.begin());
  if (i > 0) imu.T_SC0 = imu.T_SC0 * cameras.cameras[i].T_C0Ci.inverse();
  imu.time_offsets = offsetsOf(chain);
  return imu;
}

void refuseRollingShutter(const KalibrCamchain& chain) {
  for (const KalibrCamera& camera : chain.cameras) {
    if (camera.line_delay_s == 0) continue;
    throw camera.stated->fault("line_delay",
                               {InputFault::kUnsupported, "a rolling shutter (line_delay is not 0)",
                                "a global shutter", "rolling shutters are not supported yet"});
  }
}

constexpr const char* kWhat = "Kalibr's imu.yaml (update_rate and noise densities, or imu0: ...)";

std::optional<Eigen::Matrix3d> matrixOf(const YamlMap& map, const std::string& key) {
  if (!map.has(key)) return std::nullopt;
  const auto M = map.matrix(key, "a 3x3 matrix, as rows", 3, 3);
  if (M) return *M;
  throw map.fault(key, {InputFault::kBadNumber, key + " is not 3x3", "three rows of three"});
}

std::optional<Eigen::Matrix3d> matrixOf(const YamlMap& imu, const std::string& sensor,
                                        const std::string& key) {
  return imu.has(sensor) ? matrixOf(imu.map(sensor, "a mapping"), key) : std::nullopt;
}

bool differs(const std::optional<Eigen::Matrix3d>& M, const Eigen::Matrix3d& none) {
  return M && !(*M - none).isZero(1e-9);
}

bool isOpenVinsDistorted(const YamlMap& map) {
  const auto turns = [&](const char* key) {
    return differs(matrixOf(map, key), Eigen::Matrix3d::Identity());
  };
  return turns("Tw") || turns("Ta") || turns("R_IMUtoGYRO") || turns("R_IMUtoACC") ||
         differs(matrixOf(map, "Tg"), Eigen::Matrix3d::Zero());
}

}  // namespace

// The matrices are there only under models with scale and misalignment; a calibrated IMU has none.
KalibrImu kalibrImu(const YamlMap& map, const std::string& rate_key) {
  KalibrImu imu;
  imu.rostopic = map.textOr("rostopic", "");
  imu.model = map.textOr("model", "calibrated");
  imu.noise = noiseFields(map, rate_key);
  // Of the rig's first IMU, which alone is used, these are the identity and 0.
  if (map.has("T_i_b")) (void)transformField(map, "T_i_b");
  (void)map.numberOr("time_offset", 0);
  imu.accel_M = matrixOf(map, "accelerometers", "M");
  imu.gyro_M = matrixOf(map, "gyroscopes", "M");
  imu.gyro_A = matrixOf(map, "gyroscopes", "A");
  imu.C_gyro_i = matrixOf(map, "gyroscopes", "C_gyro_i");
  imu.openvins_distorted = isOpenVinsDistorted(map);
  return imu;
}

/// Kalibr lists in cam_overlaps which other cameras see the same: all of them are in the file.
void refuseMissingOverlap(const YamlMap& map, int cameras) {
  constexpr const char* kKey = "cam_overlaps";
  if (!map.has(kKey)) return;
  for (const double other : map.numbers(kKey, "a list of cameras, e.g. [1]")) {
    if (other >= 0 && other < cameras) continue;
    throw map.fault(kKey, {InputFault::kMissingKey,
                           fmt::format("cam{:g} is listed, which the file does not have", other),
                           fmt::format("cam0 to cam{} only", cameras - 1),
                           "copy the file again if it was cut; if the camera was taken out, take "
                           "it out of cam_overlaps as well"});
  }
}

KalibrCamchain readKalibrCamchain(const std::string& path) {
  return kalibrCamchainOf(YamlMap::load(path, "Kalibr's camchain*.yaml (cam0: ...)"));
}

KalibrCamchain kalibrCamchainOf(const YamlMap& file) {
  KalibrCamchain chain;
  chain.path = file.path();
  // cam0 in any case: that it is missing is then the fault that is told.
  const int count = std::max(1, file.countOf("cam"));
  for (int i = 0; i < count; ++i) {
    const std::string name = fmt::format("cam{}", i);
    const YamlMap map = file.map(name, "a camera");
    refuseMissingOverlap(map, count);
    chain.cameras.push_back(cameraOf(map, name));
  }
  return chain;
}

std::optional<ChainContradiction> chainContradiction(const KalibrCamchain& chain, std::size_t i) {
  using Suspect = ChainContradiction::Suspect;
  const KalibrCamera& camera = chain.cameras[i];
  const KalibrCamera& previous = chain.cameras[i - 1];
  if (!camera.T_cam_imu || !previous.T_cam_imu || !camera.T_cn_cnm1) return std::nullopt;
  const Transform& now = *camera.T_cam_imu;
  const Transform& before = *previous.T_cam_imu;
  const Transform& chained = *camera.T_cn_cnm1;
  // T_CiC(i-1) = T_CiS T_C(i-1)S^-1 has to be T_cn_cnm1. Where it is not, the tests below invert
  // what may stand inverted, one after the other, and ask again.
  if (agree(now * before.inverse(), chained)) return std::nullopt;
  ChainContradiction found;
  const Vector6d d = boxminus(now * before.inverse(), chained);
  found.translation_m = d.head<3>().norm();
  found.rotation_rad = d.tail<3>().norm();
  // Where several would agree, the last stands: a half turn is its own inverse.
  if (agree(now * before.inverse(), chained.inverse())) found.suspect = Suspect::kChain;
  if (agree(now.inverse() * before.inverse(), chained)) found.suspect = Suspect::kThisCamera;
  if (agree(now * before, chained)) found.suspect = Suspect::kPreviousCamera;
  if (agree(now.inverse() * before, chained)) found.suspect = Suspect::kAllCameras;
  return found;
}

bool KalibrCamchain::statesTimeOffset() const { return std::ranges::any_of(cameras, hasTimeShift); }

bool KalibrCamchain::hasImu() const { return std::ranges::any_of(cameras, hasImuPlace); }

bool KalibrCamchain::statesImuPlacesTwice() const {
  // cam0 has no T_cn_cnm1.
  return !cameras.empty() && hasImuPlace(cameras.front()) &&
         std::any_of(cameras.begin() + 1, cameras.end(),
                     [](const KalibrCamera& c) { return c.T_cam_imu && c.T_cn_cnm1; });
}

Calibration calibrationOf(const KalibrCamchain& chain) {
  refuseRollingShutter(chain);
  Calibration calibration;
  for (std::size_t i = 0; i < chain.cameras.size(); ++i) {
    if (i > 0) {
      const auto found = chainContradiction(chain, i);
      if (found) throw contradictionFault(chain, i, *found);
    }
    CameraCalibration camera;
    camera.name = chain.cameras[i].name;
    camera.rostopic = chain.cameras[i].rostopic;
    camera.intrinsics = chain.cameras[i].intrinsics;
    camera.T_C0Ci = placeInRig(chain, i, calibration);
    refuseFarPlace(*chain.cameras[i].stated, camera);
    calibration.cameras.push_back(std::move(camera));
  }
  if (chain.hasImu()) calibration.imu = imuOf(chain, calibration);
  return calibration;
}

bool KalibrImu::isDistorted() const {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  return openvins_distorted || differs(accel_M, identity) || differs(gyro_M, identity) ||
         differs(C_gyro_i, identity) || differs(gyro_A, Eigen::Matrix3d::Zero());
}

KalibrImuFile readKalibrImus(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kWhat);
  KalibrImuFile read;
  read.path = path;
  read.wrapped = file.has("imu0");
  if (!read.wrapped) {
    read.imus.push_back(kalibrImu(file));
    return read;
  }
  const int count = file.countOf("imu");
  for (int i = 0; i < count; ++i) {
    read.imus.push_back(kalibrImu(file.map(fmt::format("imu{}", i), "an IMU")));
  }
  return read;
}

}  // namespace plumbline
