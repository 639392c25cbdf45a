// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

struct ColumnName {
  std::string text;  // lower case, without its unit
  std::string unit;  // within brackets
};

bool opens(char c) { return c == '[' || c == '('; }
bool closes(char c) { return c == ']' || c == ')'; }

// Names between separators; what stands in brackets is the unit of the name before it.
std::vector<ColumnName> namesOf(std::string_view line, bool by_comma) {
  std::vector<ColumnName> names;
  bool inside = false;
  bool begin = true;
  for (const char c : lowered(line)) {
    const bool blank = c == ' ' || c == '\t';
    if (!inside && (c == ',' || (blank && !by_comma))) {
      begin = true;
    } else if (opens(c) || closes(c)) {
      inside = opens(c);
    } else if (!blank && inside && !names.empty()) {
      names.back().unit += c;
    } else if (!blank && !inside) {
      if (begin) names.emplace_back();
      begin = false;
      names.back().text += c;
    }
  }
  return names;
}

/// "t", "timestamp", "time [s]" and the like; whatever begins with "time".
bool namesTime(const std::string& name) {
  return name == "t" || name == "ts" || name == "stamp" || name.starts_with("time");
}

std::optional<int> powerOf(const std::string& unit) {
  if (unit == "ns" || unit == "nsec") return 0;
  if (unit == "us" || unit == "usec") return 3;
  if (unit == "ms" || unit == "msec") return 6;
  if (unit == "s" || unit == "sec" || unit == "seconds") return 9;
  return std::nullopt;
}

// The column of the first name that begins and ends so; -1: none.
int columnOf(const std::vector<ColumnName>& names, char first, char last) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::string& text = names[i].text;
    if (text.size() > 1 && text.front() == first && text.back() == last) return static_cast<int>(i);
  }
  return -1;
}

/// Three names in a row that end in x, y, z and begin with p or t: "tx", "px", "p_RS_R_x"; or the
/// axes alone.
/// From column 1 on, here and in columnOf(): column 0 is the stamp's.
std::optional<int> positionColumn(const std::vector<ColumnName>& names) {
  for (std::size_t i = 1; i + 2 < names.size(); ++i) {
    const auto ends = [&](std::size_t j, char axis) {
      const std::string& text = names[j].text;
      const char kind = text.size() == 1 ? 'p' : text.front();
      return text.back() == axis && (kind == 'p' || kind == 't');
    };
    if (ends(i, 'x') && ends(i + 1, 'y') && ends(i + 2, 'z')) return static_cast<int>(i);
  }
  return std::nullopt;
}

/// The columns of x, y, z, w among four names from `first` on that differ in their last letters
/// alone: "rot_w", "rot_x", "rot_y", "rot_z".
std::optional<std::array<int, 4>> adjacentQuaternion(const std::vector<ColumnName>& names,
                                                     std::size_t first) {
  const std::string& text = names[first].text;
  std::string axes;
  for (std::size_t j = first; j < first + 4; ++j) {
    if (names[j].text.starts_with(text.substr(0, text.size() - 1)) &&
        names[j].text.size() == text.size()) {
      axes += names[j].text.back();
    }
  }
  // Of single letters x, y, z are the position's.
  if (text.size() < 2 || !std::ranges::is_permutation(axes, std::string("xyzw"))) {
    return std::nullopt;
  }
  std::array<int, 4> columns{};
  for (std::size_t k = 0; k < 4; ++k) columns[k] = static_cast<int>(first + axes.find("xyzw"[k]));
  return columns;
}

/// "qx", "q_RS_w" and the like, wherever they stand; else of another word, side by side.
std::optional<std::array<int, 4>> quaternionColumns(const std::vector<ColumnName>& names) {
  const std::array<int, 4> columns = {columnOf(names, 'q', 'x'), columnOf(names, 'q', 'y'),
                                      columnOf(names, 'q', 'z'), columnOf(names, 'q', 'w')};
  if (std::ranges::all_of(columns, [](int c) { return c > 0; })) return columns;
  for (std::size_t i = 1; i + 3 < names.size(); ++i) {
    if (const auto adjacent = adjacentQuaternion(names, i)) return adjacent;
  }
  return std::nullopt;
}

constexpr double kEpochNanoseconds = 6.3e17;  // 1990; smaller stamps are no nanoseconds since 1970
constexpr int kOpenVinsColumns = 20;

struct Layout {
  TrajectoryFormat format = TrajectoryFormat::kTum;
  std::optional<int> stated_power;
  bool order_is_stated = false;
  bool has_orientation = true;
  bool has_covariance = false;
  std::size_t p = 1;
  std::array<std::size_t, 4> q = {4, 5, 6, 7};  // x, y, z, w
  int columns = 8;
};

constexpr std::array<std::size_t, 4> kScalarFirst = {5, 6, 7, 4};

/// By the header: EuRoC's has w before x, or commas and nanoseconds. Without one: more columns than
/// TUM's (velocities and biases) that are not OpenVINS' either, or commas and stamps of nanoseconds
/// since 1970.
TrajectoryFormat formatOf(const NumberRow& row, const std::optional<TableHeader>& header) {
  if (header && header->quaternion) {
    const auto& q = *header->quaternion;
    return q[3] < q[0] || (row.commas && header->stamp_power == 0) ? TrajectoryFormat::kEuroc
                                                                   : TrajectoryFormat::kTum;
  }
  const bool euroc_wide = row.columns > 8 && row.columns != kOpenVinsColumns;
  const bool euroc_rows = row.commas && row.values[0] > kEpochNanoseconds;
  return euroc_wide || euroc_rows ? TrajectoryFormat::kEuroc : TrajectoryFormat::kTum;
}

/// Columns as the header names them, which goes before what the format usually has.
void takeHeader(Layout& layout, const TableHeader& header) {
  layout.stated_power = header.stamp_power;
  layout.p = static_cast<std::size_t>(*header.position);
  if (!header.quaternion) return;
  for (std::size_t i = 0; i < 4; ++i) {
    layout.q[i] = static_cast<std::size_t>((*header.quaternion)[i]);
  }
  layout.order_is_stated = true;
}

/// The columns that the layout has: TUM 8, or 20 with OpenVINS' covariances; EuRoC 8, 11 with
/// velocities, 17 with biases; 4 for positions alone. A header that names them may have more.
bool knownCount(const NumberRow& row, const Layout& layout) {
  const auto holds = [&](std::size_t column) {
    return static_cast<std::size_t>(row.columns) > column;
  };
  if (!holds(layout.p + 2)) return false;  // where the header puts it
  if (layout.order_is_stated) return std::all_of(layout.q.begin(), layout.q.end(), holds);
  if (row.columns == 4 || row.columns == 8) return true;
  return layout.format == TrajectoryFormat::kEuroc ? row.columns == 11 || row.columns == 17
                                                   : row.columns == kOpenVinsColumns;
}

/// Whether a row of OpenVINS' length has variances where OpenVINS writes them, and not something
/// else of another program.
bool hasVariances(const NumberRow& row) {
  // Upper triangles row by row, of the orientation from column 8 and of the position from 14.
  constexpr std::array<std::size_t, 6> kDiagonals = {8, 11, 13, 14, 17, 19};
  return row.columns == kOpenVinsColumns &&
         std::all_of(kDiagonals.begin(), kDiagonals.end(),
                     // NaN: of an estimator that diverged, which is refused later.
                     [&](std::size_t column) { return !(row.values[column] <= 0); });
}

/// Whether the columns that the format has for it hold one, beside the position.
bool hasQuaternion(const NumberRow& row, const Layout& layout) {
  double squares = 0;
  for (const std::size_t column : layout.q) {
    if (column >= layout.p && column < layout.p + 3) return false;
    squares += row.values[column] * row.values[column];
  }
  return std::abs(std::sqrt(squares) - 1) <= kQuaternionTolerance;
}

Layout layoutOf(const NumberRow& row, const std::optional<TableHeader>& header,
                const std::optional<TrajectoryFormat>& asked) {
  Layout layout;
  layout.format = asked.value_or(formatOf(row, header));
  layout.columns = row.columns;
  if (layout.format == TrajectoryFormat::kEuroc) layout.q = kScalarFirst;
  if (header) takeHeader(layout, *header);
  layout.has_orientation = row.columns >= 8;
  // A header that names a position alone may name velocities where the format has the quaternion.
  const bool named = !header || header->quaternion;
  if (layout.has_orientation && !named) layout.has_orientation = hasQuaternion(row, layout);
  layout.has_covariance = layout.format == TrajectoryFormat::kTum && hasVariances(row);
  return layout;
}

void checkLayout(const TrajectorySource& source, int line, const NumberRow& row,
                 const Layout& layout) {
  if (knownCount(row, layout)) return;
  throw source.fault(
      line, {InputFault::kBadColumns, fmt::format("the row has {} columns", row.columns),
             "8 (t x y z qx qy qz qw; with OpenVINS' covariances 20), EuRoC's 4, 8, 11 or 17, or "
             "KITTI's 12",
             "name the columns in a first line '# timestamp [s] tx ty tz qx qy qz qw'"});
}

// Rows of the upper triangle that begins at `column`, as a symmetric matrix.
Eigen::Matrix3d symmetric(const NumberRow& row, std::size_t column) {
  const double* v = &row.values[column];
  Eigen::Matrix3d m;
  m << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
  return m;
}

/// OpenVINS writes the blocks of orientation and position without what lies between them. Its
/// orientation error is in the IMU's frame (JPL, of q_GtoI), ours in the outer one: R P R^T; the
/// sign of the error does not show in P.
Matrix6d openVinsCovariance(const NumberRow& row, const StampedPose& pose) {
  const Eigen::Matrix3d R = pose.transform().R;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = symmetric(row, 14);
  covariance.bottomRightCorner<3, 3>() = R * symmetric(row, 8) * R.transpose();
  return covariance;
}

StampedPose poseOf(const NumberRow& row, const Layout& layout, TimeNs t) {
  const auto& v = row.values;
  StampedPose pose;
  pose.t = t;
  pose.p = {v[layout.p], v[layout.p + 1], v[layout.p + 2]};
  if (layout.has_orientation) {
    pose.q = {v[layout.q[3]], v[layout.q[0]], v[layout.q[1]], v[layout.q[2]]};
  }
  return pose;
}

// A relative rotation has the same angle in both orders, so that smoothness tells nothing. What
// tells is a first pose that is the identity in the other order, as most estimates begin, and
// orientations that are all half a turn in this one.
void checkQuaternionOrder(const TrajectorySource& source, TrajectoryBuilder& builder,
                          const Layout& layout, bool asked) {
  const bool scalar_last = layout.q[3] == 7;
  // The identity (1, 0, 0, 0), w first, has x = 1 when it is read w last; (0, 0, 0, 1), w last, has
  // z = 1 when it is read w first.
  const auto suspect = [&](const StampedPose& pose) {
    return scalar_last ? pose.q.x() : pose.q.z();
  };
  const auto& poses = builder.poses();
  const char* const other = scalar_last ? "w x y z" : "x y z w";
  const std::string cure = fmt::format(
      "state the order in a first line '# timestamp [s] tx ty tz {}'",
      scalar_last ? "qw qx qy qz' or '... qx qy qz qw" : "qx qy qz qw' or '... qw qx qy qz");
  if (std::abs(suspect(poses.front())) == 1 && !asked) {
    throw source.fault(builder.firstLine(),
                       {InputFault::kContradiction,
                        fmt::format("the first orientation is half a turn; read as {} it would be "
                                    "the identity, so the quaternions look like {}",
                                    other, other),
                        scalar_last ? "qx qy qz qw" : "qw qx qy qz", cure});
  }
  double sum = 0;
  for (const StampedPose& pose : poses) sum += suspect(pose) * suspect(pose);
  if (sum > 0.9 * static_cast<double>(poses.size())) {
    builder.remark(fmt::format(
        "all orientations are near half a turn; if the quaternions are {}, {}", other, cure));
  }
}

Matrix6d covarianceOf(const TextTable& table, const NumberRow& row, const StampedPose& pose) {
  const Matrix6d covariance = openVinsCovariance(row, pose);
  if (covariance.allFinite()) return covariance;
  throw table.fault({InputFault::kNotFinite, "the covariance is not finite (nan or inf)",
                     "twelve finite numbers behind the quaternion",
                     "the estimator diverged here: delete these rows"});
}

void addRow(const TextTable& table, const NumberRow& row, const Layout& layout, int power,
            TrajectoryBuilder& builder) {
  table.expectColumns(row, layout.columns);
  const std::optional<TimeNs> t = parseStamp(row.stamp, power);
  if (!t) {
    throw table.fault({InputFault::kBadNumber,
                       fmt::format("the stamp '{}' is not a time", row.stamp),
                       "a decimal number within 146 years of 0", "repair or delete this line"});
  }
  const StampedPose pose = poseOf(row, layout, *t);
  builder.add(pose, table.line());
  if (layout.has_covariance) builder.addCovariance(covarianceOf(table, row, pose));
}

/// Reads ahead, in a copy of the table that stands at its first row.
FirstStamps firstStamps(TextTable ahead, const NumberRow& first) {
  constexpr std::size_t kEnough = 100;
  FirstStamps stamps{ahead.line(), first.values[0], {}};
  std::vector<double> intervals;
  for (double last = stamps.first; intervals.size() < kEnough && ahead.nextRow();) {
    const double t = ahead.numbers().values[0];
    if (!std::isfinite(t)) break;
    intervals.push_back(t - last);
    last = t;
  }
  if (intervals.size() >= 2) stamps.interval = middleOf(std::move(intervals));
  return stamps;
}

void remarkOnLayout(const Layout& layout, TrajectoryBuilder& builder) {
  const bool tum = layout.format == TrajectoryFormat::kTum;
  if (tum && layout.columns == kOpenVinsColumns && !layout.has_covariance) {
    builder.remark(
        "no covariances are read: not all variances of the first row are above 0 where OpenVINS "
        "has them");
  }
  if (layout.columns >= 8 && !layout.has_orientation) {
    builder.remark(
        "no orientations are read: the header names no quaternion (qx qy qz qw), and the first "
        "row has none where it usually stands");
  }
}

}  // namespace

std::optional<TableHeader> parseTableHeader(std::string_view line) {
  while (!line.empty() && (line.front() == '#' || line.front() == ' ')) line.remove_prefix(1);
  const std::vector<ColumnName> names = namesOf(line, line.find(',') != std::string_view::npos);
  // A stamp and a position at the least; any other comment is no header.
  if (names.size() < 4 || !namesTime(names.front().text)) return std::nullopt;
  TableHeader header;
  header.stamp_power = powerOf(names.front().unit);
  header.position = positionColumn(names);
  header.quaternion = quaternionColumns(names);
  // A position by words that are not known here stands where every format has it.
  const auto later = [](int column) { return column > 3; };
  if (!header.position && header.quaternion && std::ranges::all_of(*header.quaternion, later)) {
    header.position = 1;
  }
  if (!header.position) return std::nullopt;
  return header;
}

TrajectoryFile readPoseTable(const TrajectorySource& source, const TrajectoryReadOptions& options) {
  TextTable table(source.path, source.text, "poses");
  std::optional<TableHeader> header;
  for (const std::string_view line : table.readHeader()) {
    if (auto stated = parseTableHeader(line)) header = stated;
  }
  table.nextRow();
  const NumberRow first = table.numbers();
  const Layout layout = layoutOf(first, header, options.format);
  checkLayout(source, table.line(), first, layout);
  const StampUnit unit = decideStampUnit(source, firstStamps(table, first), layout.stated_power,
                                         layout.format == TrajectoryFormat::kEuroc ? 0 : 9);
  TrajectoryBuilder builder(source, layout.format, layout.has_orientation);
  // As many as rows of the first one's length fit.
  builder.reserve(source.text.size() / std::max<std::size_t>(table.row().size(), 1) + 1);
  addRow(table, first, layout, unit.power, builder);
  while (table.nextRow()) addRow(table, table.numbers(), layout, unit.power, builder);
  checkPoseIntervals(source, builder.poses(), unit, builder.firstLine());
  if (!unit.remark.empty()) builder.remark(unit.remark);
  remarkOnLayout(layout, builder);
  if (layout.has_orientation && !layout.order_is_stated && !options.order_is_stated) {
    checkQuaternionOrder(source, builder, layout, options.format.has_value());
  }
  return std::move(builder).finish(options.gaps_are_usual);
}

}  // namespace plumbline
