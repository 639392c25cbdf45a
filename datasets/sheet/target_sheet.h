// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {

/// In every sheet and its target.yaml.
inline constexpr const char* kSheetMark = "Plumbline target";

struct PaperSize {
  double width_mm = 0;
  double height_mm = 0;
  bool turns = false;  ///< may also lie on its side: a name says which sheet, not how it lies
};

/// "A4" to "A0", "letter", "tabloid", which may be turned, or WIDTHxHEIGHT in millimetres
/// ("900x900"), as it lies; empty for another word.
std::optional<PaperSize> paperSizeFrom(const std::string& word);

/// A sheet with an AprilGrid in its middle, at true size: tags, the squares between them, and below
/// a ruler of 100 mm with a tick every 10 mm, by which a print that was scaled is found out.
struct SheetOptions {
  AprilGrid target;  ///< its shape is not printed: the sheet is flat and even
  PaperSize paper{841, 1189, true};
  int border_bits = kKalibrBorderBits;  ///< black border of a tag in cells, 1 or 2

  /// Throws InputError where the target has no tags, more than the family, or does not fit on the
  /// paper, in either way that it may lie: then with the largest tag that does.
  void check() const;
};

/// The sheet as a PDF of one page, all vectors. Paper that may be turned lies the way that the
/// target fits best.
std::string targetSheetPdf(const SheetOptions& options);

/// Kalibr's target.yaml of a grid.
std::string targetYamlText(const AprilGrid& grid);

}  // namespace plumbline
