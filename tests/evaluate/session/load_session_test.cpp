// SPDX-License-Identifier: BSD-3-Clause
// A recording as a run takes it: the cameras asked for, what was seen, and where its files are at
// fault, to the line.
#include "evaluate/session/load_session.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

void noProgress(const std::string& /*step*/, double /*fraction*/) {}

Session recordedSession() {
  SimulationOptions options;
  options.duration_s = 2;
  return simulateSession(simulatedRig("euroc"), options).session;
}

std::string refusalToLoad(const auto& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LoadRequest, NamesWhatIsOutOfItsRange) {
  const auto refused = [](auto change) {
    LoadRequest request;
    change(request);
    return refusalToLoad([&] { request.check(); });
  };
  EXPECT_EQ(refused([](auto& r) { r.read.from_s = 1, r.read.to_s = 1.5; }), "");
  EXPECT_THAT(refused([](auto& r) { r.read.stride = 0; }), HasSubstr("stride 0"));
  EXPECT_THAT(refused([](auto& r) { r.threads = -1; }), HasSubstr("-1 threads"));
  EXPECT_THAT(refused([](auto& r) { r.read.sync_tolerance = -1; }), HasSubstr("tolerance"));
  EXPECT_THAT(refused([](auto& r) { r.read.from_s = -0.1; }), HasSubstr("from -0.1 s on"));
  EXPECT_THAT(refused([](auto& r) { r.read.from_s = NAN; }), HasSubstr("0 or more"));
  EXPECT_THAT(refused([](auto& r) { r.read.from_s = r.read.to_s = 2; }), HasSubstr("later end"));
}

/// A recording as our commands write it.
struct WrittenSession {
  TemporaryFolder folder;
  Session session = recordedSession();
  LoadRequest request;

  WrittenSession() {
    std::filesystem::create_directories(folder.path("rec"));
    // Two images without the target, and two corners of a tag that are all that is seen of it.
    session.cameras[1].views[3].corners.clear();
    session.cameras[1].views[4].corners.clear();
    session.cameras[1].views[5].corners.resize(6);
    writeCornerSession(session, folder.path("rec"));
    request.session = folder.path("rec");
  }
  LoadedSession loaded() const { return loadSession(request, noProgress); }
};

TEST(LoadSession, CountsWhatEachCameraSaw) {
  const WrittenSession w;
  const LoadedSession loaded = w.loaded();
  ASSERT_EQ(loaded.counts.size(), 2U);
  const CameraCounts& second = loaded.counts[1];
  const std::size_t views = w.session.cameras[1].views.size();
  EXPECT_EQ(second.views_offered, static_cast<int>(views));
  EXPECT_EQ(second.views_with_corners, static_cast<int>(views) - 2);
  std::size_t corners = 0, tags = 0;
  for (const ImageView& view : w.session.cameras[1].views) {
    corners += view.corners.size();
    tags += (view.corners.size() + 3) / 4;  // whole ones but the last of the sixth view
  }
  EXPECT_EQ(second.corners, corners);
  EXPECT_EQ(second.tags, tags);
  EXPECT_FALSE(loaded.shown_spacing);
  EXPECT_TRUE(loaded.images[0].empty());
}

TEST(LoadSession, KeepsTheCamerasAskedForInTheirOrder) {
  WrittenSession w;
  w.request.only = {"cam1"};
  const LoadedSession second = w.loaded();
  ASSERT_EQ(second.session.cameras.size(), 1U);
  EXPECT_EQ(second.session.cameras[0].name, "cam1");
  EXPECT_EQ(second.counts[0].views_with_corners,
            static_cast<int>(w.session.cameras[1].views.size()) - 2);
  EXPECT_EQ(second.images.size(), 1U);
  w.request.only = {"cam1", "cam0"};
  EXPECT_EQ(w.loaded().session.cameras[0].name, "cam0");
  w.request.only = {"cam2"};
  EXPECT_THAT(refusalToLoad([&] { w.loaded(); }), HasSubstr("no camera cam2; it has cam0, cam1"));
}

TEST(LoadSession, OneCameraUnderTwoNamesIsRefused) {
  WrittenSession w;
  w.session.cameras[1].views = w.session.cameras[0].views;
  std::filesystem::create_directories(w.folder.path("copy"));
  writeCornerSession(w.session, w.folder.path("copy"));
  w.request.session = w.folder.path("copy");
  EXPECT_THAT(refusalToLoad([&] { w.loaded(); }), HasSubstr("cam1 shows the very corners of cam0"));
  w.request.only = {"cam1"};
  EXPECT_EQ(refusalToLoad([&] { w.loaded(); }), "");
}

TEST(LoadSession, ACacheWithinTheRecordingIsRefused) {
  WrittenSession w;
  for (const char* inside : {"rec", "rec/mav0/cache", "other/../rec/cache"}) {
    w.request.cache = w.folder.path(inside);
    EXPECT_THAT(refusalToLoad([&] { w.loaded(); }), HasSubstr("never written to")) << inside;
  }
  w.request.cache = w.folder.path("rec_cache");
  EXPECT_EQ(refusalToLoad([&] { w.loaded(); }), "");
}

TEST(LoadSession, TheHashIsOfTheFilesAndOfThoseBeside) {
  WrittenSession w;
  const std::string alone = w.loaded().input_hash;
  EXPECT_EQ(w.loaded().input_hash, alone);
  w.request.others = {w.folder.write("camchain.yaml", "cam0: {}\n")};
  EXPECT_NE(w.loaded().input_hash, alone);
}

/// A session whose target's file has tagSize in line 4, and IMU samples from line 2 on.
struct LocatedSession {
  TemporaryFolder folder;
  LoadedSession loaded;
  LocatedSession() {
    loaded.target_path = folder.write("target.yaml",
                                      "target_type: aprilgrid\ntagRows: 6\ntagCols: 6\n"
                                      "tagSize: 0.088\ntagSpacing: 0.3\n");
    loaded.imu_samples_path =
        folder.write("data.csv", "#timestamp [ns],w,a\n1000,0\n1005,0\n10050,0\n2000,0\n");
  }
};

TEST(Locate, AFailurePointsAtItsFile) {
  LocatedSession x;
  const auto where = [&](FailureCode code) {
    return locate(Failure{code}, x.loaded, "the/session").where;
  };
  EXPECT_EQ(where(FailureCode::kScaleDisagrees), x.loaded.target_path + ":4");
  EXPECT_EQ(where(FailureCode::kAccelerometerInG), x.loaded.imu_samples_path);
  EXPECT_EQ(where(FailureCode::kCamerasShareNoFrame), "the/session");
  x.loaded.imu_samples_path.clear();
  EXPECT_EQ(where(FailureCode::kAccelerometerInG), "the/session");
  x.folder.write("target.yaml", "# tagSize is not stated\n");
  EXPECT_EQ(where(FailureCode::kScaleDisagrees), x.loaded.target_path);
}

TEST(LocateSamples, StampsAreFoundWholeInTheirLine) {
  LocatedSession x;
  Screening screening;
  screening.spikes = {{2000, 3, 1.0, 0}, {1005, 0, 1.0, 0}};
  screening.pauses = {{1000, 0.5, 0}, {1, 0.5, 0}};
  locateSamples(x.loaded, screening);
  EXPECT_EQ(screening.spikes[0].line, 5);
  EXPECT_EQ(screening.spikes[1].line, 3);
  EXPECT_EQ(screening.pauses[0].line, 2);
  EXPECT_EQ(screening.pauses[1].line, 0) << "no such stamp";
  // A bag has no lines.
  Screening of_bag;
  of_bag.spikes = {{1005, 0, 1.0, 0}};
  x.loaded.imu_samples_path = x.folder.path("data.bag");
  locateSamples(x.loaded, of_bag);
  EXPECT_EQ(of_bag.spikes[0].line, 0);
}

TEST(NoTagSeen, IsAFailureOfImagesAlone) {
  LoadedSession loaded;
  loaded.counts.resize(2);
  loaded.images.resize(2);
  EXPECT_FALSE(noTagSeen(loaded)) << "it came as corners";
  loaded.images[0].resize(5);
  loaded.images[1].resize(7);
  const auto failure = noTagSeen(loaded);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->number("images"), 12);
  loaded.counts[1].views_with_corners = 1;
  EXPECT_FALSE(noTagSeen(loaded));
}

/// What is said of a board whose file states another spacing than its corners show.
std::string spacingRefused(double stated, const std::optional<double>& shown_by_images,
                           bool with_cameras) {
  LocatedSession x;
  x.loaded.session = recordedSession();
  x.loaded.session.target.spacing = stated;
  x.loaded.shown_spacing = shown_by_images;
  const std::vector<CameraCalibration> cameras = simulatedRig("euroc").calibration.cameras;
  return refusalToLoad([&] {
    checkTargetLayout(x.loaded, with_cameras ? cameras : std::vector<CameraCalibration>());
  });
}

/// What is said of a session of that camera's corners, changed.
std::string neighboursRefused(const std::function<void(Session&)>& change) {
  LocatedSession x;
  x.loaded.session = recordedSession();
  change(x.loaded.session);
  return refusalToLoad([&] { checkTargetLayout(x.loaded, {}); });
}

void renumber(CameraStream& camera, const std::array<int, 4>& numbers) {
  for (ImageView& view : camera.views) {
    for (Corner& corner : view.corners) {
      corner.id = corner.id - corner.id % 4 + numbers[static_cast<std::size_t>(corner.id % 4)];
    }
  }
}

TEST(CheckTargetLayout, TagColsIsBlamedWhereAnotherNumberFits) {
  for (const int cols : {4, 5, 7, 9}) {
    EXPECT_THAT(neighboursRefused([&](Session& s) { s.target.cols = cols; }),
                AllOf(HasSubstr("target.yaml:3: tagCols is " + std::to_string(cols)),
                      HasSubstr("nearly all with 6 columns")));
  }
}

// Other detectors begin at the top left, or turn the other way; of one camera or of all.
TEST(CheckTargetLayout, AnotherOrderOfTheCornersIsNamed) {
  const std::array<int, 4> from_top_left = {3, 2, 1, 0}, turned = {1, 2, 3, 0},
                           reversed = {1, 0, 3, 2};
  EXPECT_THAT(neighboursRefused([&](Session& s) { renumber(s.cameras[0], from_top_left); }),
              HasSubstr("cam0/corners.csv: the corners of each tag are numbered top-left, "
                        "top-right, bottom-right, bottom-left; expected bottom-left, "));
  for (const auto& numbers : {from_top_left, turned, reversed}) {
    EXPECT_THAT(neighboursRefused([&](Session& s) {
                  for (CameraStream& camera : s.cameras) renumber(camera, numbers);
                }),
                HasSubstr("are numbered"));
  }
}

// In the sum over cameras half of the tags stand in line.
TEST(CheckTargetLayout, AnotherOrderOfOneCamerasCornersIsThatCameras) {
  for (const std::size_t camera : {0U, 1U}) {
    EXPECT_THAT(neighboursRefused([&](Session& s) {
                  renumber(s.cameras[camera], {1, 2, 3, 0});
                }),
                AllOf(HasSubstr("cam" + std::to_string(camera) + "/corners.csv: "),
                      HasSubstr("numbered top-left, bottom-left, bottom-right, top-right")));
  }
}

TEST(CheckTargetLayout, MirroredImagesOfACameraAreNamed) {
  const auto mirrored = [](std::vector<std::size_t> cameras) {
    return neighboursRefused([&](Session& s) {
      for (const std::size_t camera : cameras) {
        for (ImageView& view : s.cameras[camera].views) {
          for (Corner& corner : view.corners) corner.uv.x() = 751 - corner.uv.x();
        }
      }
    });
  };
  EXPECT_EQ(mirrored({}), "");
  EXPECT_THAT(mirrored({0}), AllOf(HasSubstr("cam0/corners.csv: "), HasSubstr("run clockwise")));
  EXPECT_THAT(mirrored({1}), HasSubstr("cam1/corners.csv: "));
  EXPECT_THAT(mirrored({0, 1}), HasSubstr("cam0/corners.csv: "));
}

TEST(CheckTargetLayout, FalseCornersAreNotCalledColumns) {
  const std::string refusal = neighboursRefused([](Session& s) {
    int i = 0;
    for (CameraStream& camera : s.cameras) {
      for (ImageView& view : camera.views) {
        for (Corner& corner : view.corners) corner.uv.x() += 40 * (i++ * 7 % 11 % 3);
      }
    }
  });
  EXPECT_THAT(refusal, AllOf(HasSubstr("neither another number of columns nor another order"),
                             Not(HasSubstr("tagCols is"))));
}

// The board was made with gaps of 0.3 tags. Behind known cameras a tenth is the bound, in pixels of
// unknown lenses half as much again.
TEST(CheckTargetLayout, TheSpacingIsHeldAgainstWhatTheCornersShow) {
  EXPECT_EQ(spacingRefused(0.3, {}, false), "");
  EXPECT_EQ(spacingRefused(0.3, {}, true), "");
  EXPECT_EQ(spacingRefused(0.28, {}, true), "");
  EXPECT_THAT(spacingRefused(0.265, {}, true),
              AllOf(HasSubstr("target.yaml:5: "), HasSubstr("tagSpacing is 0.265"),
                    HasSubstr("gaps of 0.3 times")));
  EXPECT_THAT(spacingRefused(0.2, {}, false), HasSubstr("tagSpacing is 0.2"));
  EXPECT_THAT(spacingRefused(0.45, {}, false), HasSubstr("tagSpacing is 0.45"));
  // What the detector saw comes first, by the closer bound.
  EXPECT_THAT(spacingRefused(0.3, 0.35, false), HasSubstr("gaps of 0.35 times"));
  EXPECT_EQ(spacingRefused(0.3, 0.32, false), "");
}

TEST(WasEstimatedFrom, GoesByTheHashOrTheName) {
  LoadedSession loaded;
  loaded.input_hash = "sha256:aa";
  loaded.session.name = "calib_1";
  CalibrationExtras from;
  from.input = "calib_1";
  EXPECT_EQ(wasEstimatedFrom(from, loaded), std::nullopt) << "the file does not say";
  from.input_hash = "sha256:bb";
  EXPECT_EQ(wasEstimatedFrom(from, loaded), true) << "with other files beside it";
  from.input = "calib_2";
  EXPECT_EQ(wasEstimatedFrom(from, loaded), false);
  from.input_hash = "sha256:aa";
  EXPECT_EQ(wasEstimatedFrom(from, loaded), true) << "renamed";
}

// Another name, another shape of the board, without the IMU: the corners are the same.
TEST(WasEstimatedFrom, GoesByWhatACameraRecorded) {
  LoadedSession loaded;
  loaded.input_hash = "xxh64:aa";
  loaded.camera_hashes = {"xxh64:1", "xxh64:2"};
  CalibrationExtras from;
  from.input = "elsewhere";
  from.input_hash = "xxh64:bb";
  from.camera_hashes = {"xxh64:3"};
  EXPECT_EQ(wasEstimatedFrom(from, loaded), false);
  from.camera_hashes.push_back("xxh64:2");
  EXPECT_EQ(wasEstimatedFrom(from, loaded), true);
}

TEST(AssumptionsOf, AreThoseOfTheStagesAndOfTheSessionsImu) {
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  camera.pixel_sigma = 0.25;
  camera.cauchy_px = 1.5;
  camera_imu.pixel_sigma = 0.7;
  camera_imu.gravity_m_s2 = 9.7;
  Session session;
  const Assumptions cameras = assumptionsOf(camera, camera_imu, &session);
  EXPECT_EQ(cameras.pixel_sigma_px, 0.25);
  EXPECT_EQ(cameras.gravity_m_s2, 9.7);
  EXPECT_EQ(cameras.loss, "cauchy:1.5");
  EXPECT_FALSE(cameras.imu_noise);
  session.imu.emplace().noise.gyro_density = 0.125;
  EXPECT_EQ(assumptionsOf(camera, camera_imu, &session).imu_noise->gyro_density, 0.125);
  EXPECT_EQ(lossText(0), "none");
}

}  // namespace
}  // namespace plumbline
