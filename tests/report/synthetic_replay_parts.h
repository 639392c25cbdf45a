// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/records/replay_record.h"

namespace plumbline::test {

// What syntheticReplay() is made of.

/// Two pinhole cameras without distortion, 752 x 480, 11 cm apart.
std::vector<CameraCalibration> syntheticStereo();

class SyntheticRig {
 public:
  SyntheticRig(const AprilGrid& target, const std::vector<CameraCalibration>& cameras)
      : target_(target), cameras_(cameras) {}

  /// T_FC0 at frame f of n.
  Transform wander(int f, int n) const;
  /// The corners that lie in each image.
  std::vector<std::vector<Corner>> seenFrom(const Transform& T_FC0) const;
  /// Views on a lattice, frontal and tilted, every 17th not scored; the best gains `best_nats`.
  CandidateRound views(int f, double best_nats) const;
  /// Six trajectories, of which one cannot be flown.
  CandidateRound trajectories(int f, double best_nats) const;
  /// The round's best; in the camera-IMU stage with a path.
  Suggestion suggest(int id, const Decision& d, const CandidateRound& round) const;

 private:
  Transform lookAt(const Eigen::Vector3d& from, double roll) const;

  AprilGrid target_;
  std::vector<CameraCalibration> cameras_;
};

/// Stages, audits, compliance, counterfactuals, verdict.
void addJudgements(ReplayRecord& record);

/// A JPEG per camera at half the resolution: tags on noise, another for each frame.
std::vector<std::string> pictures(const std::vector<std::vector<Corner>>& corners, int frame);

}  // namespace plumbline::test
