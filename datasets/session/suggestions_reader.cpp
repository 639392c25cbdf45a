// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "datasets/files/table.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_folder.h"

namespace plumbline {
namespace {

constexpr const char* kSuggestionsLayout =
    "t_ns, stage, id, T_FC0 (tx ty tz qx qy qz qw, or a 4x4 matrix)";
// Of a quaternion's length, and of R R^T in its norm: numbers with four decimals pass.
constexpr double kUnitTolerance = 1e-3;

GuideStage stageFrom(TextTable& table) {
  const std::string word(table.word("stage"));
  for (const GuideStage stage : {GuideStage::kCamera, GuideStage::kCameraImu}) {
    if (word == toString(stage)) return stage;
  }
  throw table.fault(
      {InputFault::kUnknownWord, "the stage is '" + word + "'", "camera or camera-imu"});
}

Transform fromQuaternion(const TextTable& table, const std::vector<double>& n) {
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (std::abs(q.norm() - 1) > kUnitTolerance) {
    throw table.fault({InputFault::kNotRigid,
                       fmt::format("the quaternion has norm {:.6g}", q.norm()), "norm 1",
                       "columns are tx ty tz qx qy qz qw, the real part last"});
  }
  return {q, {n[0], n[1], n[2]}};
}

/// Twelve or sixteen numbers row by row; a fourth row says nothing new.
Transform fromRows(const TextTable& table, const std::vector<double>& n) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 4; ++col) T(row, col) = n[static_cast<std::size_t>(4 * row + col)];
  }
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (off > kUnitTolerance || R.determinant() < 0) {
    throw table.fault({InputFault::kNotRigid, "the upper left 3x3 of T_FC0 is not a rotation",
                       "orthonormal rows", "write the matrix row by row"});
  }
  return Transform::fromMatrix(T);
}

Transform poseFrom(TextTable& table) {
  std::vector<double> numbers;
  while (table.moreCells()) numbers.push_back(table.number("T_FC0"));
  switch (numbers.size()) {
    case 7:
      return fromQuaternion(table, numbers);
    case 12:
    case 16:
      return fromRows(table, numbers);
    default:
      throw table.fault({InputFault::kBadNumber,
                         fmt::format("T_FC0 has {} numbers", numbers.size()), "7, 12 or 16"});
  }
}

}  // namespace

std::vector<Suggestion> readSuggestions(const std::string& path) {
  const MappedFile file(path);
  TextTable table(path, file.text(), kSuggestionsLayout);
  table.readHeader(TextTable::NoRows::kAccept);
  std::vector<Suggestion> suggestions;
  std::set<std::pair<GuideStage, int>> ids;
  while (table.nextRow()) {
    Suggestion s;
    s.t = table.stamp();
    // Several may have one stamp.
    if (!suggestions.empty() && s.t < suggestions.back().t) {
      checkAscending(table, s.t, suggestions.back().t, "sort the rows by time");
    }
    s.stage = stageFrom(table);
    s.id = table.integer("id");
    // Each stage counts by itself.
    if (!ids.insert({s.stage, s.id}).second) {
      throw table.fault({InputFault::kDuplicate,
                         fmt::format("the id {} is given twice in this stage", s.id),
                         "one row per suggestion", "delete one of the rows"});
    }
    s.candidate = fmt::format("{}", s.id);
    s.T_FC0 = poseFrom(table);
    suggestions.push_back(std::move(s));
  }
  return suggestions;
}

std::optional<std::string> findSuggestions(const std::string& session) {
  return findBeside(besideSession(session), "suggestions.csv");
}

}  // namespace plumbline
