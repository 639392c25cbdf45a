// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/frames.h"
#include "datasets/files/bad_input.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

// The instant `seconds` after `start`; the largest stamp for infinity.
TimeNs instant(TimeNs start, double seconds) {
  if (seconds > 1e9) return std::numeric_limits<TimeNs>::max();
  return start + toNanoseconds(seconds);
}

// Frames are counted as pairs of views, so that cameras with dropped images stay together under a
// stride.
std::vector<int> wantedFrames(const std::vector<Frame>& frames, const SessionReadOptions& options) {
  std::vector<int> wanted;
  const TimeNs from = instant(frames.front().t, options.from_s);
  const TimeNs to = instant(frames.front().t, options.to_s);
  int index = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].t < from || frames[f].t > to) continue;
    if (index++ % options.stride == 0) wanted.push_back(static_cast<int>(f));
  }
  return wanted;
}

void trimImu(ImuStream& imu, TimeNs first_frame, const SessionReadOptions& options) {
  const TimeNs from = instant(first_frame, options.from_s - options.imu_margin_s);
  const TimeNs to = instant(first_frame, options.to_s + options.imu_margin_s);
  std::erase_if(imu.samples, [&](const ImuSample& s) { return s.t < from || s.t > to; });
}

}  // namespace

void SessionReadOptions::check() const {
  const auto refuse = [](const std::string& text) { throw BadInput(InputFault::kBadOption, text); };
  if (stride < 1) {
    refuse(fmt::format("stride is {}; expected 1 or more; 2 keeps every second frame", stride));
  }
  if (!(from_s >= 0) || !(to_s > from_s)) {
    refuse(
        fmt::format("from {:g} to {:g} is no interval; expected 0 <= from < to, in seconds "
                    "after the first frame; correct them",
                    from_s, to_s));
  }
  if (!(imu_margin_s >= 0) || sync_tolerance < 0) {
    refuse("the IMU's margin and the tolerance of frames are 0 or more");
  }
  if (resolution && (resolution->width < 1 || resolution->height < 1)) {
    refuse("the resolution is two positive numbers of pixels");
  }
}

void selectFrames(Recording& recording, const SessionReadOptions& options) {
  if (options.from_s == 0 && std::isinf(options.to_s) && options.stride == 1) return;
  Session& session = recording.session;
  const std::vector<Frame> frames = pairFrames(session.cameras, {options.sync_tolerance, 0});
  if (frames.empty()) return;
  const ViewChoice kept = viewsOf(session, frames, wantedFrames(frames, options));
  std::size_t left = 0;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    auto& images = recording.images[c];  // none where corners came from a file
    if (images.size() == kept[c].size()) images = chosen(images, kept[c]);
    session.cameras[c].views = chosen(session.cameras[c].views, kept[c]);
    left += session.cameras[c].views.size();
  }
  if (left == 0) {
    const double length = secondsBetween(frames.front().t, frames.back().t);
    throw BadInput(InputFault::kNothingSelected,
                   fmt::format("from {:g} to {:g} leaves no frame; expected an interval "
                               "within the recording's {:.1f} s; correct them",
                               options.from_s, options.to_s, length));
  }
  const bool whole = options.from_s == 0 && std::isinf(options.to_s);
  if (session.imu && !whole) trimImu(*session.imu, frames.front().t, options);
}

}  // namespace plumbline
