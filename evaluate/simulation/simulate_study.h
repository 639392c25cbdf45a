// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/simulate/operator/operator_skill.h"
#include "evaluate/results/progress.h"

namespace plumbline {

/// What the guide of a simulated study knows of the board's own shape.
enum class GuideBoard {
  kMeasured,  ///< all of it, as a lab knows it that has measured its one board before
  kFlat,      ///< nothing
};
constexpr std::array<const char*, 2> enumWords(GuideBoard /*of*/) { return {"measured", "flat"}; }

/// A simulated user study.
struct StudySimulationOptions {
  int participants = 16;
  double duration_s = 60;  ///< of a free recording, about [s]
  std::uint64_t seed = 1;
  double learning = 0.85;  ///< errors, reaction and time of the second session over the first's
  double corner_sigma_px = 0.2;
  double board_bend_mm = 0.3;  ///< RMS across the board; half of it along, the other way
  GuideBoard guide_board = GuideBoard::kMeasured;
  int held_out = 4;     ///< evaluation recordings
  int sequences = 10;   ///< with motion capture
  bool images = false;  ///< of the sequences, for odometry
  int threads = 0;      ///< 0: all cores; nothing written depends on it

  /// Who is not done by then counts as having given up [s].
  double limitS() const;
  /// Suggested trajectories that a guided session is over after.
  int trajectories() const;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// One session of a simulated participant.
struct SimulatedVisit {
  std::string name;    ///< "p01_free"
  std::string method;  ///< "free" or "guided"
  int period = 1;
  OperatorSkill skill;    ///< as it is in this period
  double duration_s = 0;  ///< of a free recording; the limit of a guided one
  bool gives_up = false;  ///< patience is cut short
  std::uint64_t seed = 0;
};

struct SimulatedParticipant {
  std::string name;                    ///< "p01"
  double clumsiness = 0;               ///< 0: the most skilled, 1: the least
  std::vector<SimulatedVisit> visits;  ///< in their order
};

/// Crossover: who begins with the guide is drawn, half of the participants (rounded
/// down). Skills are spread evenly over the participants, in random order. In the second session
/// errors, reaction and duration are `learning` times those of the first, speeds and reach its
/// inverse, within OperatorSkill's limits. Of four participants or more two give up, one with each
/// method, at two fifths of the duration. Equal options give equal participants.
std::vector<SimulatedParticipant> simulatedParticipants(const StudySimulationOptions& options);

/// The same session with the same luck, had the person made it in the other period (1 or 2).
SimulatedVisit inOtherPeriod(const SimulatedParticipant& person, const SimulatedVisit& visit,
                             const StudySimulationOptions& options);

/// What was made of a study.
struct StudySimulationSummary {
  int sessions = 0, gave_up = 0;
  int suggestions = 0;  ///< that ended before their recording did
  int reached = 0;      ///< of them
  /// Median lengths of finished sessions; empty: nobody finished one.
  std::optional<double> free_s, guided_s;
};

/// Writes a user study into `folder`, which is there and empty:
///   STUDY.yaml                     as `plumbline study` reads it
///   truth.json                     rig, board, participants, effects, what every session was
///   sessions/NAME/                 recordings with corners; guided ones with suggestions.csv
///   evaluation/evalNN/             recordings of the rig that no method saw
///   sequences/seqNN/               likewise, with mav0/mocap0/data.csv, truth/ and, if asked for,
///                                  images in place of corners
/// The rig is "d435i" (stereo 15 Hz, IMU 400 Hz, the paper's noise densities). All recordings show
/// one board that is bent and not quite even, which target.yaml does not say. Free recordings and
/// guided ones are those of operated_session.h. Equal options give equal bytes.
StudySimulationSummary simulateStudy(const StudySimulationOptions& options,
                                     const std::filesystem::path& folder,
                                     const ProgressSink& progress);

}  // namespace plumbline
