// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/files/bad_input.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {

/// A file's text in memory, as the readers of the formats take it.
struct TrajectorySource {
  std::string path;
  std::string_view text;

  InputError fault(int line, const Complaint& complaint) const {
    return badInput(path, line, complaint);
  }
};

/// The median of the intervals between poses, of which there must be two.
TimeNs medianInterval(const std::vector<StampedPose>& poses);

/// Largest | |q| - 1 | that is a rounded unit quaternion; two decimals leave 0.01.
constexpr double kQuaternionTolerance = 0.02;

/// Takes poses in the order of the file and refuses those that no trajectory has: numbers that are
/// not finite, quaternions that are far from unit length, stamps that descend.
class TrajectoryBuilder {
 public:
  TrajectoryBuilder(const TrajectorySource& source, TrajectoryFormat format, bool has_orientation);

  void reserve(std::size_t poses) { file_.trajectory.poses.reserve(poses); }
  /// Throws InputError with the line.
  void add(const StampedPose& pose, int line);
  void addCovariance(const Matrix6d& covariance) {
    file_.trajectory.covariances.push_back(covariance);
  }
  void remark(std::string text) { file_.remarks.push_back(std::move(text)); }
  const std::vector<StampedPose>& poses() const { return file_.trajectory.poses; }
  int firstLine() const { return first_line_; }

  /// The trajectory with remarks on equal stamps and gaps. Throws InputError where it is empty.
  TrajectoryFile finish() &&;

 private:
  void checkOrder(const StampedPose& pose, int line);

  TrajectorySource source_;
  TrajectoryFile file_;
  int first_line_ = 0;
  int equal_stamps_ = 0;
  int equal_line_ = 0;  // of the first equal stamp
};

}  // namespace plumbline
