// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {

/// A reading that its neighbours contradict; its sample is not integrated.
struct ImuSpike {
  TimeNs t = 0;     ///< of the sample, as recorded
  int channel = 0;  ///< 0 to 2: gyroscope x, y, z; 3 to 5: accelerometer
  double size = 0;  ///< reading less what the neighbours say [rad/s, m/s^2]
  int line = 0;     ///< of the file, for who knows it
};

/// A pause between two samples that breaks the chain of motion.
struct ImuPause {
  TimeNs t = 0;           ///< of the sample before it, as recorded
  double duration_s = 0;  ///< to the next one
  int line = 0;           ///< of the sample before it, for who knows the file
};

/// A view that repeats the corners of the one before it, although the rig moved.
struct RepeatedView {
  int camera = 0;
  TimeNs t = 0;  ///< the view's own stamp
};

/// A tag that stands where another's id belongs.
struct MisplacedTag {
  int camera = 0;
  TimeNs t = 0;   ///< the view's own stamp
  int tag = 0;    ///< id that was read
  int place = 0;  ///< tag in whose place it stands
};

/// Measurements that contradict their neighbours or the target's geometry, and were left out.
struct Screening {
  std::vector<ImuSpike> spikes;
  std::vector<ImuPause> pauses;
  std::vector<RepeatedView> repeated_views;
  std::vector<MisplacedTag> misplaced_tags;
  /// Far off where their view says they are; left out under a robust loss.
  std::size_t false_corners = 0;
  std::size_t grazing_corners = 0;  ///< seen at 89 degrees and more from the optical axis

  bool empty() const {
    return spikes.empty() && pauses.empty() && repeated_views.empty() && misplaced_tags.empty() &&
           false_corners == 0 && grazing_corners == 0;
  }
};

}  // namespace plumbline
