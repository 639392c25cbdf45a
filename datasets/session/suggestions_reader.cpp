// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/suggestions_reader.h"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "datasets/files/file_io.h"
#include "datasets/files/table.h"
#include "datasets/session/session_folder.h"
#include "datasets/session/stamps.h"

namespace plumbline {
namespace {

constexpr const char* kSuggestionsLayout =
    "t_ns, stage, id, T_FC0 (tx ty tz qx qy qz qw, or a 4x4 matrix), camera (may be left out)";
// Of a quaternion's length, and of R R^T in its norm: numbers with four decimals pass.
constexpr double kUnitTolerance = 1e-3;
constexpr int kMostCameras = 1000;

GuideStage stageFrom(TextTable& table) {
  const std::string word(table.word("stage"));
  if (const auto stage = enumFrom<GuideStage>(word)) return *stage;
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
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topRows<3>() = Eigen::Map<const Rows>(n.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (off > kUnitTolerance || R.determinant() < 0) {
    throw table.fault({InputFault::kNotRigid, "the upper left 3x3 of T_FC0 is not a rotation",
                       "orthonormal rows", "write the matrix row by row"});
  }
  return Transform::fromMatrix(T);
}

/// The camera's number stands after the pose, which has 7, 12 or 16 numbers; -1 without one.
int takeCamera(const TextTable& table, std::vector<double>& numbers) {
  const std::size_t n = numbers.size();
  if (n != 8 && n != 13 && n != 17) return -1;
  const double camera = numbers.back();
  if (camera < 0 || camera > kMostCameras || camera != std::floor(camera)) {
    throw table.fault({InputFault::kBadNumber, fmt::format("the camera is {:g}", camera),
                       "0, 1, ...: for whose image the view was made"});
  }
  numbers.pop_back();
  return static_cast<int>(camera);
}

Transform poseFrom(const TextTable& table, const std::vector<double>& numbers) {
  const std::size_t n = numbers.size();
  if (n == 7) return fromQuaternion(table, numbers);
  if (n == 12 || n == 16) return fromRows(table, numbers);
  throw table.fault({InputFault::kBadNumber, fmt::format("T_FC0 has {} numbers", n),
                     "7, 12 or 16, and the camera's after them"});
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
    std::vector<double> numbers;
    while (table.moreCells()) numbers.push_back(table.number("T_FC0"));
    s.camera = takeCamera(table, numbers);
    s.T_FC0 = poseFrom(table, numbers);
    suggestions.push_back(std::move(s));
  }
  return suggestions;
}

std::optional<std::string> findSuggestions(const std::string& session) {
  return findBeside(besideSession(session), "suggestions.csv");
}

}  // namespace plumbline
