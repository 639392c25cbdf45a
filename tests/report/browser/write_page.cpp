// SPDX-License-Identifier: BSD-3-Clause
// Writes the page of a synthetic record: write_page FILE [frames] [camera-only], or write_page FILE
// perturbation|trajectory|long-names|comparison|study. The browser test opens what it writes; with
// the frames of a long recording it is also the timing of a page.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "evaluate/metrics/trajectory/run_comparison.h"
#include "report/html/pages.h"
#include "tests/report/synthetic_record.h"
#include "tests/report/synthetic_studies.h"
#include "tests/report/synthetic_user_study.h"

namespace {

/// Of sequences and calibrations with names as long as those of whole experiments.
plumbline::TrajectoryRecord longNames() {
  plumbline::TrajectoryRecord r = plumbline::test::syntheticTrajectories();
  for (plumbline::TrajectoryRun& run : r.runs) {
    run.sequence = "euroc_vicon_room_" + run.sequence + "_medium";
    run.calibration = "calibration_with_kalibr_and_corner_filter_" + run.calibration;
  }
  static_cast<plumbline::TrajectoryStudy&>(r) = plumbline::studyOf(std::move(r.runs));
  return r;
}

/// Empty for a word that is no study.
std::string studyPage(const std::string& kind) {
  using namespace plumbline;
  if (kind == "perturbation") return renderPerturbationPage(test::syntheticPerturbation());
  if (kind == "trajectory") return renderTrajectoryPage(test::syntheticTrajectories());
  if (kind == "long-names") return renderTrajectoryPage(longNames());
  if (kind == "study") return renderStudyPage(test::syntheticUserStudy());
  if (kind == "comparison") return renderComparisonPage(test::syntheticComparison());
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  if (const std::string page = argc == 3 ? studyPage(argv[2]) : ""; !page.empty()) {
    std::ofstream(argv[1]) << page;
    return 0;
  }
  if (argc < 2) {
    std::fprintf(stderr, "usage: write_page FILE [frames] [camera-only]; FILE STUDY\n");
    return 2;
  }
  plumbline::test::SyntheticRecordOptions options;
  if (argc > 2) options.frames = std::atoi(argv[2]);
  options.camera_imu = argc < 4;
  options.tags_seen = options.frames > 1000 ? 32 : 20;
  const auto record = plumbline::test::syntheticRecord(options);
  const auto start = std::chrono::steady_clock::now();
  const std::string page = plumbline::renderCalibrationPage(record);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::ofstream(argv[1]) << page;
  std::printf("%zu corners a stage, %zu bytes, rendered in %.2f s\n",
              record.camera->residuals.size(), page.size(), seconds.count());
  return 0;
}
