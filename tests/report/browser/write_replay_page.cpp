// SPDX-License-Identifier: BSD-3-Clause
// Writes the page of a synthetic replay, and beside it FILE.decisions with what its log must say:
// write_replay_page FILE FRAMES COLUMNS_OF_TAGS [images|errors|bare]; without frames the record is
// empty, "bare" leaves it nothing but its corners, with "errors" predicted errors decide.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "report/html/pages.h"
#include "tests/report/synthetic_replay.h"

namespace {

/// Mean of the corners of the first tag that is seen whole.
std::optional<Eigen::Vector2d> firstTag(const std::vector<plumbline::Corner>& corners) {
  for (std::size_t i = 0; i + 3 < corners.size(); ++i) {
    if (corners[i].id % 4 != 0 || corners[i + 3].id != corners[i].id + 3) continue;
    return 0.25 * (corners[i].uv + corners[i + 1].uv + corners[i + 2].uv + corners[i + 3].uv);
  }
  return std::nullopt;
}

/// What the log must say of each frame, in the order of the decisions, with all digits: frame,
/// seconds, stage, mode, reason, gain, entropy, suggestion, distance, centre of camera 0's first
/// whole tag; "-" where there is none.
void writeDecisions(const plumbline::ReplayRecord& record, const std::string& path) {
  std::ofstream file(path);
  file.precision(17);
  const auto write = [&file](const auto& value) {
    if (value) {
      file << ' ' << *value;
    } else {
      file << " -";
    }
  };
  for (const plumbline::Decision& d : record.decisions) {
    file << d.frame << ' ' << 1e-9 * static_cast<double>(d.t - record.frames.front().t) << ' '
         << toString(d.stage) << ' ' << toString(d.mode) << ' ' << toString(d.reason);
    write(d.mi_nats);
    write(d.entropy_nats);
    write(d.suggestion);
    write(d.distance_px);
    const auto centre = firstTag(record.frames[static_cast<std::size_t>(d.frame)].corners[0]);
    write(centre ? std::optional(centre->x()) : std::nullopt);
    write(centre ? std::optional(centre->y()) : std::nullopt);
    file << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr,
                 "usage: write_replay_page FILE FRAMES COLUMNS_OF_TAGS [images|errors|bare]\n");
    return 2;
  }
  plumbline::test::SyntheticReplayOptions options;
  options.frames = std::atoi(argv[2]);
  options.columns = std::atoi(argv[3]);
  const std::string with = argc > 4 ? argv[4] : "";
  options.images = with == "images";
  options.by_error = with == "errors";
  plumbline::ReplayRecord record;
  if (options.frames > 0) record = plumbline::test::syntheticReplay(options);
  if (with == "bare") {
    plumbline::ReplayRecord bare;
    bare.frames = record.frames;
    record = bare;
  }
  std::ofstream(argv[1]) << plumbline::renderReplayPage(record);
  writeDecisions(record, std::string(argv[1]) + ".decisions");
  return 0;
}
