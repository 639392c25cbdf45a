// SPDX-License-Identifier: BSD-3-Clause
// The figures that evo, rpg_trajectory_evaluation and ov_eval gave for real trajectories, computed
// again from the files. Proves that each tool's conventions are known and can be had; says nothing
// about which convention is right (docs/trajectory_conventions.md does).
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/trajectory/trajectory_reader.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/metrics/trajectory/errors.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

const std::string kFolder = PLUMBLINE_SHARED_DATA "/trajectories/";
constexpr std::size_t kEntries = 457;
constexpr double kRelative = 1e-9;

// Entries (from 0) whose `min` is rounding and nothing else: the alignment makes the first pair's
// poses coincide, so their error is zero but for the order of operations. Both values are below
// 1e-13 m or degrees; only for ov_eval's entry 314, where unnormalised quaternions leave 1.4e-7
// degrees, is it their difference that is.
const std::set<std::size_t> kMinIsRounding = {11,  45,  79,  112, 113, 143, 151, 159,
                                              167, 175, 183, 191, 199, 213, 214, 246,
                                              247, 261, 262, 276, 277, 314};
constexpr double kRounding = 1e-13;

enum class Tool { kEvo, kRpg, kOvEval };

Tool toolOf(const Json& entry) {
  const std::string name = entry.at("tool");
  if (name == "evo") return Tool::kEvo;
  return name == "rpg_trajectory_evaluation" ? Tool::kRpg : Tool::kOvEval;
}

AssociationOptions associationOf(const Json& entry) {
  AssociationOptions options;
  options.rule = std::map<Tool, AssociationRule>{{Tool::kEvo, AssociationRule::kEvo},
                                                 {Tool::kRpg, AssociationRule::kRpg},
                                                 {Tool::kOvEval, AssociationRule::kOvEval}}
                     .at(toolOf(entry));
  options.max_dt_s = entry.at("max_time_diff_s");
  return options;
}

AlignmentOptions alignmentOf(const Json& entry) {
  static const std::map<std::string, AlignmentKind> kinds{
      {"none", AlignmentKind::kNone},
      {"none(scale=1)", AlignmentKind::kNone},
      {"se3", AlignmentKind::kSe3},
      {"se3_umeyama_all", AlignmentKind::kSe3},
      {"sim3", AlignmentKind::kSim3},
      {"sim3_umeyama_all", AlignmentKind::kSim3},
      {"posyaw", AlignmentKind::kYaw},
      {"posyawsingle", AlignmentKind::kYawFirst},
      {"se3single", AlignmentKind::kSe3First},
      {"origin_se3", AlignmentKind::kOrigin},
      {"scale_only", AlignmentKind::kScale},
      {"se3_umeyama_first_50", AlignmentKind::kSe3}};
  const std::string name = entry.at("alignment");
  AlignmentOptions options;
  options.kind = kinds.at(name);
  if (name == "se3_umeyama_first_50") options.first_n = 50;
  if (entry.contains("align_num_frames") && entry["align_num_frames"] == 1) {
    options.kind = name == "se3" ? AlignmentKind::kSe3First : AlignmentKind::kYawFirst;
  }
  if (toolOf(entry) == Tool::kOvEval) options.quaternions = QuaternionUse::kAsRead;
  return options;
}

AbsoluteMeasure absoluteMeasureOf(const Json& entry) {
  static const std::map<std::string, AbsoluteMeasure> measures{
      {"translation_part", AbsoluteMeasure::kTranslation},
      {"rotation_angle_deg", AbsoluteMeasure::kRotationDeg},
      {"rotation_part", AbsoluteMeasure::kRotationPart},
      {"full_transformation", AbsoluteMeasure::kFullTransformation},
      {"xy_2d", AbsoluteMeasure::kXy},
      {"yaw_2d_signed_deg", AbsoluteMeasure::kYawDeg},
      {"yaw_abs_deg", AbsoluteMeasure::kHeadingDeg}};
  return measures.at(entry.at("pose_relation"));
}

RelativeMeasure relativeMeasureOf(const Json& entry) {
  static const std::map<std::string, RelativeMeasure> measures{
      {"translation_part", RelativeMeasure::kTranslation},
      {"rotation_angle_deg", RelativeMeasure::kRotationDeg},
      {"rel_trans_m", RelativeMeasure::kTranslation},
      {"rel_trans_perc", RelativeMeasure::kTranslation},
      {"rel_rot_deg", RelativeMeasure::kRotationDeg},
      {"rel_yaw_deg", RelativeMeasure::kHeadingDeg},
      {"rel_gravity_deg", RelativeMeasure::kGravityDeg}};
  return measures.at(entry.at("pose_relation"));
}

std::vector<IndexPair> evoPairs(const Json& entry, const AlignedPoses& poses) {
  const double delta = entry.at("delta");
  const bool all = entry.at("all_pairs");
  if (entry.at("delta_unit") == "frames") {
    const auto step = static_cast<std::size_t>(delta);
    return all ? overlappingFrames(poses.truth.size(), step)
               : consecutiveFrames(poses.truth.size(), step);
  }
  const double tolerance = delta * entry.at("rel_delta_tol").get<double>();
  return all ? subTrajectories(pathLengths(poses.estimate), {delta, tolerance})
             : consecutiveSegments(poses.estimate, delta);
}

std::vector<IndexPair> pairsOf(const Json& entry, const AlignedPoses& poses) {
  if (toolOf(entry) == Tool::kEvo) return evoPairs(entry, poses);
  SubTrajectoryRule rule;
  rule.length = entry.at("delta");
  rule.tolerance = toolOf(entry) == Tool::kRpg ? entry.at("max_dist_diff").get<double>() : 0.5;
  rule.inclusive = false;
  rule.may_stay = true;
  return subTrajectories(pathLengths(poses.truth), rule);
}

std::vector<PosePair> thinned(const std::vector<PosePair>& pairs, const Json& entry) {
  const std::size_t step = entry.value("matched_pose_decimation", 1);
  std::vector<PosePair> kept;
  for (std::size_t i = 0; i < pairs.size(); i += step) kept.push_back(pairs[i]);
  return kept;
}

std::vector<double> errorsOf(const Json& entry, const AlignedPoses& poses) {
  if (entry.at("metric") == "APE") return absoluteErrors(poses, absoluteMeasureOf(entry));
  std::vector<double> errors =
      relativeErrors(poses, pairsOf(entry, poses), relativeMeasureOf(entry));
  if (entry.at("pose_relation") == "rel_trans_perc") {
    for (double& error : errors) error *= 100 / entry.at("delta").get<double>();
  }
  return errors;
}

// The alignment of the entry as scale, R and t, if it has one.
void expectAlignment(const Json& entry, const AlignmentRecord& ours) {
  const auto near = [](const Json& rows, const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(R(i, j), rows[i][j], 1e-9);
      if (rows[i].size() == 4) {
        EXPECT_NEAR(t[i], rows[i][3], 1e-9);
      }
    }
  };
  const Transform& T = ours.T_truth_estimate;
  if (ours.kind == "scale") {  // evo notes the similarity, and applies its scale alone
    const Json& row = entry["alignment_T_gt_est_sim3"][0];
    EXPECT_NEAR(ours.scale, Eigen::Vector3d(row[0], row[1], row[2]).norm(), 1e-9);
  } else if (entry.contains("alignment_T_gt_est_sim3")) {
    near(entry["alignment_T_gt_est_sim3"], ours.scale * T.R, T.t);
  }
  if (entry.contains("R") && !entry["R"].is_null()) {
    near(entry["R"], T.R, T.t);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(T.t[i], entry["t"][i], 1e-9);
    EXPECT_NEAR(ours.scale, entry["scale"], 1e-9);
  }
}

void expectStatistics(const Json& entry, std::size_t index, const std::vector<double>& errors) {
  const SampleStatistics s = sampleStatistics(errors, entry.at("std_ddof").get<int>());
  const std::map<std::string, double> ours{
      {"rmse", s.rmse},     {"mean", s.mean},
      {"median", s.median}, {"std", s.std},
      {"min", s.min},       {"max", s.max},
      {"sse", s.sse},       {"gauss_p99", s.mean + 2.326 * s.std}};
  for (const auto& [name, value] : ours) {
    if (name == "gauss_p99" && !entry.contains(name)) continue;
    const double expected = entry.at(name);
    // A minimum of exactly zero comes from the same cause; another compiler may round it otherwise.
    const bool rounding = name == "min" && (expected == 0 || kMinIsRounding.contains(index));
    const double tolerance = rounding ? kRounding : kRelative * std::abs(expected);
    EXPECT_NEAR(value, expected, tolerance) << name;
  }
  EXPECT_EQ(errors.size(), entry.at("n_errors").get<std::size_t>());
}

class Files {
 public:
  const Trajectory& operator[](const std::string& name) {
    if (!files_.contains(name)) files_[name] = readTrajectory(kFolder + name).trajectory;
    return files_[name];
  }

 private:
  std::map<std::string, Trajectory> files_;
};

TEST(ReferenceErrors, EveryEntryOfEveryTool) {
  std::ifstream in(kFolder + "reference_errors.json");
  ASSERT_TRUE(in) << "no reference_errors.json in " << kFolder;
  const Json entries = Json::parse(in).at("entries");
  ASSERT_EQ(entries.size(), kEntries);
  Files files;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Json& entry = entries[i];
    SCOPED_TRACE("entry " + std::to_string(i) + ": " + entry.dump().substr(0, 300));
    const Association association =
        associate(files[entry.at("est_file")], files[entry.at("gt_file")], associationOf(entry));
    EXPECT_EQ(association.pairs.size(), entry.at("n").get<std::size_t>());
    const AlignmentOptions options = alignmentOf(entry);
    const Result<AlignmentRecord> alignment = align(association.pairs, options);
    ASSERT_TRUE(alignment.ok());
    expectAlignment(entry, *alignment);
    const AlignedPoses poses =
        alignedPoses(thinned(association.pairs, entry), *alignment, options.quaternions);
    expectStatistics(entry, i, errorsOf(entry, poses));
  }
}

// Figures of the data's own notes, under this program's default rule.
double se3Rmse(const std::string& estimate, const std::string& truth) {
  Files files;
  const Association association = associate(files[estimate], files[truth], {});
  const Result<AlignmentRecord> alignment = align(association.pairs, {});
  EXPECT_TRUE(alignment.ok());
  return sampleStatistics(absoluteErrors(alignedPoses(association.pairs, *alignment),
                                         AbsoluteMeasure::kTranslation))
      .rmse;
}

TEST(ReferenceErrors, OneToOneWhereEvoUsesPosesTwice) {
  EXPECT_NEAR(se3Rmse("V102.txt", "V102_groundtruth.csv"), 0.0917309404, 5e-11);
}

TEST(ReferenceErrors, OrbSlam3OnMh01) {
  for (const char* run : {"run1_stereo", "run2_stereo", "run3_stereo"}) {
    const double rmse =
        se3Rmse(std::string("orbslam3_MH01/") + run + ".txt", "MH_01_easy_groundtruth.txt");
    EXPECT_GT(rmse, 0.0255) << run;
    EXPECT_LT(rmse, 0.0435) << run;
  }
}

TEST(ReferenceErrors, OpenVinsSuffersFromAWrongCalibration) {
  const auto rmse = [](const std::string& kind) {
    return se3Rmse("openvins_wrong_calibration/openvins_MH01_" + kind + "_full_000.tum",
                   "MH_01_easy_groundtruth.txt");
  };
  EXPECT_NEAR(rmse("nominal"), 0.0955, 5e-5);
  EXPECT_GT(rmse("rot_z_5deg"), 1.5 * rmse("nominal"));
}

}  // namespace
}  // namespace plumbline
