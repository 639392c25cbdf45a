// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/rig.h"

#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

/// Row-major 3x4 matrix [R t].
Transform transformOf(const std::array<double, 12>& rows) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topRows<3>() = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>::Map(rows.data());
  // The digits that were published are rounded: projected on SO(3) here.
  return Transform::fromMatrix(T);
}

/// A pinhole: fu, fv, pu, pv, and what its lens does.
struct Lens {
  Eigen::Vector4d projection, distortion;
};

/// Two cameras of one kind.
SimulatedRig stereo(const std::string& name, double camera_rate_hz, Resolution resolution,
                    DistortionModel distortion, const std::array<Lens, 2>& lenses,
                    const Transform& T_C0C1) {
  SimulatedRig rig{name, {}, camera_rate_hz};
  for (const Lens& lens : lenses) {
    CameraCalibration& c = rig.calibration.cameras.emplace_back();
    c.name = "cam" + std::to_string(rig.calibration.cameras.size() - 1);
    c.rostopic = "/" + c.name + "/image_raw";
    c.intrinsics.distortion_model = distortion;
    c.intrinsics.resolution = resolution;
    c.intrinsics.projection = lens.projection;
    c.intrinsics.distortion = lens.distortion;
  }
  rig.calibration.cameras[1].T_C0Ci = T_C0C1;
  rig.calibration.imu.emplace();
  return rig;
}

SimulatedRig euroc() {
  const Transform T_SC0 = transformOf({0.0148655429818, -0.999880929698, 0.00414029679422,  //
                                       -0.0216401454975,                                    //
                                       0.999557249008, 0.0149672133247, 0.025715529948,     //
                                       -0.064676986768,                                     //
                                       -0.0257744366974, 0.00375618835797, 0.999660727178,  //
                                       0.00981073058949});
  const Transform T_SC1 = transformOf({0.0125552670891, -0.999755099723, 0.0182237714554,  //
                                       -0.0198435579556,                                   //
                                       0.999598781151, 0.0130119051815, 0.0251588363115,   //
                                       0.0453689425024,                                    //
                                       -0.0253898008918, 0.0179005838253, 0.999517347078,  //
                                       0.00786212447038});
  SimulatedRig rig = stereo("euroc", 20, {752, 480}, DistortionModel::kRadtan,
                            {Lens{{458.654, 457.296, 367.215, 248.375},
                                  {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}},
                             Lens{{457.587, 456.134, 379.999, 255.238},
                                  {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05}}},
                            T_SC0.inverse() * T_SC1);
  rig.calibration.imu->T_SC0 = T_SC0;
  rig.calibration.imu->time_offsets = {{0.0021}};
  // Gyroscope: density, random walk; accelerometer: density, random walk; rate.
  rig.calibration.imu->noise = {1.6968e-4, 1.9393e-5, 2.0e-3, 3.0e-3, 200};
  return rig;
}

SimulatedRig tumvi() {
  // Kalibr's T_cam_imu of camera 0 and T_cn_cnm1 of camera 1.
  const Transform T_C0S = transformOf({-0.99952504, 0.02961534, -0.00852233, 0.04727988,   //
                                       0.00750192, -0.03439736, -0.99938008, -0.04744323,  //
                                       -0.02989013, -0.99896935, 0.03415885, -0.06819996});
  const Transform T_C1C0 = transformOf({0.99999943, -0.00083618, -0.00066128, -0.10092123,  //
                                        0.00080425, 0.99889894, -0.04690685, -0.00196454,   //
                                        0.00069978, 0.04690629, 0.99889905, -0.00146636});
  SimulatedRig rig = stereo("tumvi", 20, {512, 512}, DistortionModel::kEquidistant,
                            {Lens{{190.97847715, 190.97330705, 254.93170606, 256.89744290},
                                  {0.00348238940, 0.00071503485, -0.00205323614, 0.00020293674}},
                             Lens{{190.44236969, 190.43443847, 252.59949717, 254.91723065},
                                  {0.00340031708, 0.00176627815, -0.00266312570, 0.00032995174}}},
                            T_C1C0.inverse());
  rig.calibration.imu->T_SC0 = T_C0S.inverse();
  rig.calibration.imu->time_offsets = {{-0.0037}};
  rig.calibration.imu->noise = {1.6e-4, 2.2e-5, 2.8e-3, 8.6e-4, 200};
  return rig;
}

SimulatedRig d435i() {
  // Small rotations as (1, x, y, z), normalised by Transform.
  const Transform T_C0C1(Eigen::Quaterniond(1, 0.0011, -0.0017, 0.0006),
                         Eigen::Vector3d(0.05003, 0.00012, -0.00021));
  SimulatedRig rig =
      stereo("d435i", 15, {640, 480}, DistortionModel::kRadtan,
             {Lens{{384.61, 384.23, 321.87, 238.42}, {0.0094, -0.0127, 0.00041, -0.00033}},
              Lens{{385.02, 384.75, 320.35, 239.16}, {0.0081, -0.0109, -0.00027, 0.00052}}},
             T_C0C1);
  rig.calibration.imu->T_SC0 = {Eigen::Quaterniond(1, 0.0041, -0.0027, 0.0036),
                                Eigen::Vector3d(0.00552, -0.00510, -0.01174)};
  rig.calibration.imu->time_offsets = {{0.0113}};
  // As the paper states them (gyroscope 2.78e-3 and 1.65e-5, accelerometer 2.52e-2 and 4.41e-3).
  rig.calibration.imu->noise = {2.78e-3, 1.65e-5, 2.52e-2, 4.41e-3, 400};
  return rig;
}

}  // namespace

SimulatedRig simulatedRig(const std::string& name) {
  if (name == "euroc") return euroc();
  if (name == "tumvi") return tumvi();
  if (name == "d435i") return d435i();
  throw InputError(fmt::format("unknown rig '{}'; expected one of {}", name,
                               fmt::join(simulatedRigNames(), ", ")));
}

std::vector<std::string> simulatedRigNames() { return {"euroc", "tumvi", "d435i"}; }

}  // namespace plumbline
