// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// A number at the top of the page; a wide one has room for a long note.
struct Card {
  std::string label, value, unit, note;
  bool wide = false;
};
std::vector<Card> keyFigures(const CalibrationRecord& record);

/// "cam0: fu, fv [px], k1 [-]; T_C0C1: tx [m]": the parameters of a covariance by owner, a unit
/// after the last of its run.
std::string parameterList(const ParameterCovariance& covariance);

struct ParameterRow {
  std::string name, value, std, unit, spread, ratio;
  std::string interval;  ///< half width of the 90 % interval
  std::string formal;    ///< beside a cluster-robust std
};
struct ParameterGroup {
  std::string heading;
  bool has_spread = false;
  bool has_interval = false;
  bool has_formal = false;
  std::vector<ParameterRow> rows;
};
/// One group per camera, per extrinsic transform, and for the IMU.
std::vector<ParameterGroup> parameterGroups(const CalibrationRecord& record);

/// The time offset as each tool writes it: `number` is what stands in its field, `value` the same
/// in a unit that people read.
struct OffsetRow {
  std::string tool, field, number, value, note;
};
std::vector<OffsetRow> offsetRows(double time_offset_s, std::optional<double> std_s);

struct Pair {
  std::string label, value;
};
/// Target, what was detected, and the file that was scored.
std::vector<Pair> calibrationRows(const CalibrationRecord& record);
/// Version, command, input, date, options; rows without a value are left out.
std::vector<Pair> provenanceRows(const Provenance& provenance);
/// Corner noise, loss, and with an IMU gravity and noise densities.
std::vector<Pair> assumptionRows(const Assumptions& assumptions);

}  // namespace plumbline::html_internal
