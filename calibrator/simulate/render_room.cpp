// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/render_room.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/image_formation.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

constexpr float kTexel = static_cast<float>(RoomTexture::kTexel_m);
constexpr double kRectanglesPerM2 = 7;
constexpr double kEdge_px = 1.2;  // blur of the texture, so that texels do not show

std::size_t index(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

/// A side's light while it is being painted, `width` texels wide.
struct Canvas {
  int width = 0, height = 0;
  std::vector<float> light;
};

/// Values at the knots of a grid of `cell_m`, bilinear between them.
void addNoise(Canvas& canvas, double cell_m, double amplitude, RandomStream& random) {
  const double per_texel = RoomTexture::kTexel_m / cell_m;
  const int cols = static_cast<int>(canvas.width * per_texel) + 2;
  const int rows = static_cast<int>(canvas.height * per_texel) + 2;
  std::vector<float> knots(index(0, rows, cols));
  for (float& knot : knots) knot = static_cast<float>(amplitude * random.uniform(-1, 1));
  for (int y = 0; y < canvas.height; ++y) {
    const double v = y * per_texel;
    const auto row = static_cast<int>(v);
    const auto b = static_cast<float>(v - row);
    for (int x = 0; x < canvas.width; ++x) {
      const double u = x * per_texel;
      const auto col = static_cast<int>(u);
      const auto a = static_cast<float>(u - col);
      const float* k = &knots[index(col, row, cols)];
      canvas.light[index(x, y, canvas.width)] +=
          (1 - b) * ((1 - a) * k[0] + a * k[1]) + b * ((1 - a) * k[cols] + a * k[cols + 1]);
    }
  }
}

/// Sides between 0.04 and 0.5 m, even in their logarithm; `side` is half of one, in texels.
void paintRectangle(Canvas& canvas, RandomStream& random) {
  const double u = random.uniform(0, canvas.width), v = random.uniform(0, canvas.height);
  const auto side = [&] {
    return 0.5 / RoomTexture::kTexel_m * 0.04 * std::pow(0.5 / 0.04, random.uniform());
  };
  const double half_w = side(), half_h = side();
  const double angle = random.uniform(0, std::numbers::pi);
  const auto level = static_cast<float>(random.uniform(25, 225));
  const double c = std::cos(angle), s = std::sin(angle), reach = std::hypot(half_w, half_h);
  const int top = std::max(0, static_cast<int>(v - reach));
  const int bottom = std::min(canvas.height, static_cast<int>(v + reach) + 1);
  const int left = std::max(0, static_cast<int>(u - reach));
  const int right = std::min(canvas.width, static_cast<int>(u + reach) + 1);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const double dx = x - u, dy = y - v;
      if (std::abs(c * dx + s * dy) > half_w || std::abs(c * dy - s * dx) > half_h) continue;
      canvas.light[index(x, y, canvas.width)] = level;
    }
  }
}

/// A side: grey levels about 115, five sizes of noise and rectangles with sharp edges.
GrayImage painted(double width_m, double height_m, std::uint64_t seed, std::uint64_t side) {
  RandomStream random(seed, RandomPurpose::kTexture, {side});
  Canvas canvas;
  canvas.width = static_cast<int>(std::ceil(width_m / RoomTexture::kTexel_m)) + 1;
  canvas.height = static_cast<int>(std::ceil(height_m / RoomTexture::kTexel_m)) + 1;
  canvas.light.assign(index(0, canvas.height, canvas.width), 115);
  const std::array<std::pair<double, double>, 5> octaves{
      {{0.8, 30}, {0.4, 20}, {0.2, 14}, {0.1, 10}, {0.05, 8}}};
  const auto count = static_cast<int>(kRectanglesPerM2 * width_m * height_m);
  // Half of the rectangles are under the noise, half over it: plain ones beside textured ones.
  for (int i = 0; i < count / 2; ++i) paintRectangle(canvas, random);
  for (const auto& [cell_m, amplitude] : octaves) addNoise(canvas, cell_m, amplitude, random);
  for (int i = count / 2; i < count; ++i) paintRectangle(canvas, random);
  const std::vector<float> soft = gaussianBlur(canvas.light, canvas.width, canvas.height, kEdge_px);
  GrayImage image(canvas.width, canvas.height);
  std::transform(soft.begin(), soft.end(), image.data(), [](float level) {
    return static_cast<std::uint8_t>(std::clamp(level + 0.5F, 0.0F, 255.0F));
  });
  return image;
}

/// The axes of a side's plane: the other two, in ascending order.
constexpr std::array<std::array<int, 2>, 3> kAcross{{{1, 2}, {0, 2}, {0, 1}}};

/// Rays through the places (u, v) of the pixels' squares, by interpolation between their corners',
/// which is exact to 1e-6 of a pixel for lenses that change little over one.
std::vector<Eigen::Vector3f> raysAt(const std::vector<Eigen::Vector3f>& corners, int width,
                                    int height, float u, float v) {
  std::vector<Eigen::Vector3f> rays;
  rays.reserve(index(0, height, width));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector3f* above = &corners[index(x, y, width + 1)];
      const Eigen::Vector3f* below = above + width + 1;
      const bool known =
          !above[0].isZero() && !above[1].isZero() && !below[0].isZero() && !below[1].isZero();
      rays.push_back(known ? Eigen::Vector3f((1 - v) * ((1 - u) * above[0] + u * above[1]) +
                                             v * ((1 - u) * below[0] + u * below[1]))
                           : Eigen::Vector3f::Zero());
    }
  }
  return rays;
}

}  // namespace

RoomTexture::RoomTexture(const Eigen::Vector3d& room_m, std::uint64_t seed)
    : half_((0.5 * room_m).cast<float>()) {
  for (int side = 0; side < 6; ++side) {
    const auto [a, b] = kAcross[side / 2];
    sides_[side] = painted(room_m[a], room_m[b], seed, static_cast<std::uint64_t>(side));
  }
}

float RoomTexture::at(int side, const Eigen::Vector3f& p) const {
  const GrayImage& image = sides_[side];
  const auto [a, b] = kAcross[side / 2];
  const int last_x = image.width() - 1, last_y = image.height() - 1;
  const float u = std::clamp((p[a] + half_[a]) / kTexel, 0.0F, static_cast<float>(last_x));
  const float v = std::clamp((p[b] + half_[b]) / kTexel, 0.0F, static_cast<float>(last_y));
  // Before the last texel: the ones to its right and below it are read as well.
  const int x = std::min(static_cast<int>(u), last_x - 1);
  const int y = std::min(static_cast<int>(v), last_y - 1);
  const float s = u - static_cast<float>(x), t = v - static_cast<float>(y);
  const std::uint8_t* k = image.data() + index(x, y, image.width());
  const std::uint8_t* below = k + image.width();
  return (1 - t) * ((1 - s) * static_cast<float>(k[0]) + s * static_cast<float>(k[1])) +
         t * ((1 - s) * static_cast<float>(below[0]) + s * static_cast<float>(below[1]));
}

RoomRenderer::RoomRenderer(const Intrinsics& camera, std::shared_ptr<const RoomTexture> texture,
                           const RenderOptions& options)
    : width_(camera.resolution.width),
      height_(camera.resolution.height),
      options_((options.check(), options)),
      texture_(std::move(texture)),
      gain_(vignettingGain(camera.resolution, options.vignetting)) {
  const std::vector<Eigen::Vector3f> corners = cornerRays(camera);
  // A square turned by 27 degrees: no two places share a row or a column of the pixel.
  constexpr std::array<std::array<float, 2>, kPlaces> kPlace{
      {{0.375F, 0.125F}, {0.625F, 0.875F}, {0.875F, 0.375F}, {0.125F, 0.625F}}};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    rays_[i] = raysAt(corners, width_, height_, kPlace[i][0], kPlace[i][1]);
  }
}

void RoomRenderer::expose(const Transform& T_FC, const std::vector<Eigen::Vector3f>& rays,
                          std::vector<float>& light) const {
  const Eigen::Matrix3f R = T_FC.R.cast<float>();
  const Eigen::Vector3f& half = texture_->half();
  Eigen::Vector3f c = T_FC.t.cast<float>();
  c.z() -= half.z();  // from the box's middle
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3f n = R * rays[i];
    float range = std::numeric_limits<float>::max();
    int side = -1;
    for (int axis = 0; axis < 3; ++axis) {
      if (n[axis] == 0) continue;
      const bool up = n[axis] > 0;
      const float reach = ((up ? half[axis] : -half[axis]) - c[axis]) / n[axis];
      // From within a box, the side that the ray reaches first.
      if (reach < range) {
        range = reach;
        side = 2 * axis + (up ? 1 : 0);
      }
    }
    // A ray of any length does, for range is in units of it; a ray of length zero (none) reaches no
    // side and stays dark.
    if (side >= 0) light[i] += texture_->at(side, c + range * n);
  }
}

GrayImage RoomRenderer::render(const std::vector<Transform>& T_FC, std::uint64_t image) const {
  std::vector<float> light(gain_.size(), 0.0F);
  const std::size_t count = std::max(T_FC.size(), kPlaces);  // a single pose: at every place
  for (std::size_t i = 0; i < count; ++i) {
    expose(T_FC[i % T_FC.size()], rays_[i % kPlaces], light);
  }
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] *= gain_[i] / static_cast<float>(count);
  }
  const std::vector<float> soft = gaussianBlur(light, width_, height_, options_.blur_sigma_px);
  return exposeSensor(soft, width_, height_, options_.noise_sigma, options_.seed, image);
}

std::vector<Transform> exposurePoses(const SimulatedSession& session, int camera, TimeNs t,
                                     double exposure_s) {
  const double offset_s = session.truth.imu->timeOffset();
  const double middle_s = secondsBetween(session.start_ns, t) + offset_s;
  const MotionState m = session.trajectory.at(middle_s);
  const Intrinsics& lens = session.truth.cameras[camera].intrinsics;
  // At 2 m, as walls are on the way through the default room. It only chooses how many
  // sub-exposures there are: nearer ones blur a little more coarsely.
  const double blur_px = (m.omega_B.norm() + m.v_F.norm() / 2) * exposure_s * pixelsPerRadian(lens);
  // In fours, so that every place of the pixel (kPlaces) has as many sub-exposures.
  const int count = std::clamp(4 * static_cast<int>(std::ceil(blur_px / 4)), 4, 16);
  const Transform T_SC = session.truth.imu->T_SC0 * session.truth.cameras[camera].T_C0Ci;
  std::vector<Transform> poses;
  for (int k = 0; k < count; ++k) {
    // Middles of equal parts, so that their mean is the stamp's instant.
    const double t_s = middle_s + exposure_s * ((k + 0.5) / count - 0.5);
    poses.push_back(session.trajectory.at(t_s).T_FB * T_SC);
  }
  return poses;
}

}  // namespace plumbline
