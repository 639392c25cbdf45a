// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/simulate_operator.h"

#include <utility>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/fields/json_fields.h"
#include "calibrator/simulate/rig.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_writer.h"
#include "datasets/session/target.h"
#include "evaluate/simulation/operated_session.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

OperatedOptions operatedOptions(const OperatorSimulationOptions& o) {
  OperatedOptions operated;
  // One seed for sensors and person, whose random numbers are of different streams.
  operated.simulation.seed = operated.simulation.trajectory.seed = o.seed;
  operated.simulation.duration_s = o.duration_s;
  operated.simulation.corner_sigma_px = o.corner_sigma_px;
  operated.simulation.target.shape = bentBoard(o.board_bend_mm);
  operated.skill = o.skill;
  if (o.method == OperatorMethod::kDance) operated.skill.own_views = OwnViewsKind::kDance;
  operated.guide = o.guide;
  // Else flat, as a guide takes a board that nobody has measured.
  if (o.guide_board == GuideBoard::kMeasured) {
    operated.guide_shape = operated.simulation.target.shape;
  }
  operated.trajectories = o.trajectories;
  operated.operator_seed = o.seed;
  return operated;
}

/// Of camera 0 in F at the exposure of each frame, under the stamp of its view.
std::string posesCsv(const OperatedSession& made) {
  std::string text = "#t_ns,tx [m],ty [m],tz [m],qx,qy,qz,qw\n";
  const auto& views = made.session.cameras.front().views;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const Transform& T = made.T_FC0[k];
    const Eigen::Quaterniond q = T.quaternion();
    text += fmt::format("{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n", views[k].t,
                        T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

/// What became of every suggestion, times since the first frame.
Json outcomesOf(const OperatedSession& made) {
  const TimeNs begin = made.session.cameras.front().views.front().t;
  Json all = Json::array();
  for (const Suggestion& s : made.suggestions) {
    // "none" stays where the recording ended with the suggestion open.
    Json one{{"id", s.id},
             {"stage", toString(s.stage)},
             {"candidate", s.candidate},
             {"shown_s", secondsBetween(begin, s.t)},
             {"reach_s", toJson(s.reach_s)},
             {"end", toString(SuggestionEvent::kNone)}};
    if (const Decision* end = endOf(made, s.id)) {
      one["end"] = toString(end->event);
      one["after_s"] = secondsBetween(s.t, end->t);
    }
    all.push_back(std::move(one));
  }
  return all;
}

/// The skill in figures: whatever word it was given by, single ones may have been set apart.
Json optionsOf(const OperatorSimulationOptions& o, const OperatedOptions& operated) {
  return {{"method", toString(o.method)},
          {"criterion", toString(o.guide.views.criterion)},
          {"seed", o.seed},
          {"duration_s", o.duration_s},
          {"corner_sigma_px", o.corner_sigma_px},
          {"board_bend_mm", o.board_bend_mm},
          {"guide_board", toString(o.guide_board)},
          {"trajectories", o.trajectories},
          {"operator_speed_m_s", o.guide.pace.speed_m_s},
          {"stop_projection_px", o.guide.views.stop_projection_px},
          {"stop_reprojection_px", o.guide.trajectories.stop_reprojection_px},
          {"first_trajectory", toString(o.guide.trajectories.first)},
          {"trajectory_s", o.guide.trajectories.duration_s},
          {"trajectory_amplitude", o.guide.trajectories.amplitude},
          {"trajectory_roll_rad", o.guide.trajectories.roll_rad},
          {"reached_px", o.guide.views.reached_px},
          {"reached_s", o.guide.views.reached_s},
          {"trajectory_held_s", o.guide.trajectories.reached_s},
          {"skill", toJson(operated.skill)}};
}

std::string truthOf(const SimulatedRig& rig, const OperatorSimulationOptions& o,
                    const OperatedOptions& operated, const OperatedSession& made,
                    const OperatorSimulationSummary& summary) {
  Json truth{{"schema", 1}, {"rig", rig.name}, {"options", optionsOf(o, operated)}};
  truth.update(toJson(rig.calibration));
  truth["board"] = toJson(operated.simulation.target.shape);
  truth["finished"] = made.finished;
  truth["camera_s"] = made.camera_s;
  truth["camera_imu_s"] = made.camera_imu_s;
  truth["reached"] = made.reached;
  truth["suggestions"] = outcomesOf(made);
  if (summary.convergence) truth["convergence"] = toJson(*summary.convergence);
  if (summary.stops.cameras || summary.stops.camera_imu) truth["stop"] = toJson(summary.stops);
  return truth.dump(2) + "\n";
}

}  // namespace

void OperatorSimulationOptions::check() const {
  skill.check();
  guide.check();
  requireWithin(5, 3600, "duration_s", duration_s);
  requireWithin(0, 100, "corner_sigma_px", corner_sigma_px);
  requireWithin(0, 20, "board_bend_mm", board_bend_mm);
  requireWithin(0, 1000, "trajectories", trajectories);
}

OperatorSimulationSummary simulateOperator(const OperatorSimulationOptions& o,
                                           const fs::path& folder) {
  o.check();
  const SimulatedRig rig = simulatedRig(o.rig);
  const OperatedOptions operated = operatedOptions(o);
  const bool guided = o.method == OperatorMethod::kGuided;
  const OperatedSession made = guided ? recordGuided(rig, operated) : recordFreely(rig, operated);
  const auto ended = static_cast<std::size_t>(endedSuggestions(made));
  OperatorSimulationSummary summary{made.finished,     made.camera_s,
                                    made.camera_imu_s, static_cast<int>(ended),
                                    made.reached,      ended < made.suggestions.size(),
                                    std::nullopt,      {}};
  if (o.judge) summary.convergence = convergenceOf(made, operated, rig.calibration);
  // A stop is the guide's; nobody stops a free recording.
  if (o.judge && guided) {
    summary.stops.cameras = stopHindsight({made, operated, rig}, GuideStage::kCamera);
    summary.stops.camera_imu = stopHindsight({made, operated, rig}, GuideStage::kCameraImu);
  }
  writeSession(made.session, rig.camera_rate_hz, ViewFormat::kCorners, folder);
  if (guided) writeNewFile(folder, "suggestions.csv", suggestionsCsv(made.suggestions));
  const fs::path truth = "truth";
  writeNewFile(folder, truth / "truth.json", truthOf(rig, o, operated, made, summary));
  writeNewFile(folder, truth / "camchain-imucam.yaml", kalibrCamchainText(rig.calibration));
  writeNewFile(folder, truth / "poses.csv", posesCsv(made));
  if (!operated.simulation.target.shape.isFlat()) {
    writeNewFile(folder, truth / kTargetShapeFile, targetShapeText(operated.simulation.target));
  }
  return summary;
}

}  // namespace plumbline
