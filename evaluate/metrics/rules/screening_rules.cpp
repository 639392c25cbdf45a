// SPDX-License-Identifier: BSD-3-Clause
// Measurements that were left out because they contradict their neighbours or the target.
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostListed = 4;
constexpr std::array<const char*, 6> kChannels{"gyroscope x",     "gyroscope y",
                                               "gyroscope z",     "accelerometer x",
                                               "accelerometer y", "accelerometer z"};

/// "a, b, c, d and 7 more".
template <class List, class Words>
std::string listed(const List& list, const Words& words) {
  std::string out;
  for (std::size_t k = 0; k < list.size() && k < kMostListed; ++k) {
    out += (k == 0 ? "" : ", ") + words(list[k]);
  }
  if (list.size() > kMostListed) out += fmt::format(" and {} more", list.size() - kMostListed);
  return out;
}

std::string spikeWords(const ImuSpike& s) {
  const bool gyro = s.channel < 3;
  return fmt::format("{} at {} ({:+.3g} {})", kChannels.at(static_cast<std::size_t>(s.channel)),
                     sampleName(s.t, s.line), s.size, gyro ? "rad/s" : "m/s^2");
}

std::string tagWords(const MisplacedTag& m, const std::vector<CameraCalibration>& cameras) {
  const std::string& camera = cameras[static_cast<std::size_t>(m.camera)].name;
  return fmt::format("tag {} of {}, frame {}, is at the position of tag {}", m.tag, camera, m.t,
                     m.place);
}

/// "no spikes", or "3 spikes: " with the list.
std::string counted(std::size_t count, const char* what, const std::string& list) {
  return count == 0 ? fmt::format("no {}", what) : fmt::format("{} {}: {}", count, what, list);
}

}  // namespace

// Lines are known of samples that were read from a table, which a session has in this place only.
std::string sampleName(TimeNs t, int line) {
  return line > 0 ? fmt::format("imu0/data.csv:{}", line) : fmt::format("stamp {}", t);
}

Findings judgeScreening(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  const Screening& s = stage.screening;
  Findings findings;
  findings.push_back(
      // What was left out does no harm any more: the bounds make the first one a caution, and
      // hardly any number bad.
      above({"Spikes of the IMU", "1", t.imu_spikes,
             "These samples were excluded. Single readings far from their neighbours come from "
             "errors of the bus or the driver: find the cause, because an estimator that runs on "
             "this IMU will see them too."},
            static_cast<double>(s.spikes.size()),
            counted(s.spikes.size(), "isolated readings", listed(s.spikes, spikeWords))));
  findings.push_back(above(
      {"Views delivered twice", "1", t.repeated_views,
       "These views were excluded. The camera or its driver repeated an image under a new stamp: "
       "look for lost frames that were filled up, and a bus that is overloaded."},
      static_cast<double>(s.repeated_views.size()),
      counted(s.repeated_views.size(), "views repeat the corners before them though the rig moved",
              listed(s.repeated_views, [&](const RepeatedView& r) {
                return fmt::format("{} at {}",
                                   stage.cameras[static_cast<std::size_t>(r.camera)].name, r.t);
              }))));
  findings.push_back(
      above({"Tags with another's id", "1", t.misplaced_tags,
             "These tags were excluded. Look at the images there: a reflection, a second target, "
             "or a detector that accepts too many wrong bits."},
            static_cast<double>(s.misplaced_tags.size()),
            counted(s.misplaced_tags.size(), "tags are not at the position of their id",
                    listed(s.misplaced_tags,
                           [&](const MisplacedTag& m) { return tagWords(m, stage.cameras); }))));
  // A share and no count: single false corners are no finding.
  const auto offered = static_cast<double>(stage.summary.corners_offered);
  const double wrong = share(static_cast<double>(s.false_corners), offered);
  findings.push_back(
      above({"False corners", "share", t.false_corners,
             "A robust loss leaves them out, --loss none does not; find the cause (blur, "
             "reflections, a wrong refinement window)."},
            wrong,
            fmt::format("{} of {:.0f} corners are far from where the rest of their view puts them",
                        s.false_corners, offered)));
  return findings;
}

}  // namespace plumbline
