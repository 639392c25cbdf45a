// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sheet/target_sheet.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kMargin = 5;       // [mm], that printers leave white
constexpr double kStrip = 16;       // [mm], of ruler and text below the target
constexpr double kRuler = 100;      // [mm]
constexpr double kRulerLine = 0.3;  // [mm]

constexpr std::array<std::pair<const char*, PaperSize>, 7> kPapers{
    {{"A4", {210, 297, true}},
     {"A3", {297, 420, true}},
     {"A2", {420, 594, true}},
     {"A1", {594, 841, true}},
     {"A0", {841, 1189, true}},
     {"letter", {215.9, 279.4, true}},
     {"tabloid", {279.4, 431.8, true}}}};

std::optional<double> numberFrom(std::string_view word) {
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || stop != word.data() + word.size()) return std::nullopt;
  if (!(value >= 20 && value <= 1e5)) return std::nullopt;
  return value;
}

/// Everything in millimetres on the paper, y downwards, as it lies.
struct SheetLayout {
  PaperSize paper;
  double left = 0, bottom = 0;  ///< of tag 0's outer corner
  double tag = 0, pitch = 0, gap = 0;
  double width = 0, height = 0;  ///< with the squares around
};

SheetLayout sized(const AprilGrid& grid) {
  SheetLayout l;
  l.tag = 1e3 * grid.tag_size;
  l.pitch = 1e3 * grid.pitch();
  l.gap = l.pitch - l.tag;
  l.width = l.pitch * grid.cols + l.gap;
  l.height = l.pitch * grid.rows + l.gap;
  return l;
}

/// How often the target would fit.
double room(const SheetLayout& l, const PaperSize& paper) {
  // The ruler may be wider than a small target.
  const double across = std::max(l.width, kRuler);
  return std::min((paper.width_mm - 2 * kMargin) / across,
                  (paper.height_mm - 2 * kMargin - kStrip) / l.height);
}

PaperSize turned(const PaperSize& paper) { return {paper.height_mm, paper.width_mm, paper.turns}; }

/// As the paper lies below the target. The strip of the ruler stays at the bottom either way, so
/// that the two differ even for a square target.
PaperSize lying(const SheetLayout& l, const PaperSize& paper) {
  return paper.turns && room(l, turned(paper)) > room(l, paper) ? turned(paper) : paper;
}

/// Centred on the paper, with the strip of the ruler kept free below.
SheetLayout layoutOf(const SheetOptions& o) {
  SheetLayout l = sized(o.target);
  l.paper = lying(l, o.paper);
  l.left = 0.5 * (l.paper.width_mm - l.width) + l.gap;
  l.bottom = 0.5 * (l.paper.height_mm - kStrip + l.height) - l.gap;
  return l;
}

struct Context {
  explicit Context(cairo_surface_t* on) : surface(on), cr(cairo_create(on)) {}
  ~Context() {
    cairo_destroy(cr);
    cairo_surface_destroy(surface);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  cairo_surface_t* surface;
  cairo_t* cr;
};

/// Black cells of a row side by side are one rectangle, and all of a tag one path: no seams.
void addTag(cairo_t* cr, const SheetLayout& l, int tag, double left, double bottom,
            int border_bits) {
  const int cells = tagCells(border_bits);
  const double cell = l.tag / cells;
  for (int row = 0; row < cells; ++row) {
    for (int col = 0; col < cells;) {
      int end = col;
      while (end < cells && cellIsBlack(tag, end, row, border_bits)) ++end;
      if (end > col) {
        cairo_rectangle(cr, left + col * cell, bottom - (row + 1) * cell, (end - col) * cell, cell);
      }
      // The cell at `end` is white, or beyond the tag.
      col = end + 1;
    }
  }
  cairo_fill(cr);
}

/// A black square at every crossing of the gaps, outer ones included, as Kalibr's targets have
/// them: hence one more row and column than tags.
void drawTarget(cairo_t* cr, const SheetLayout& l, const SheetOptions& o) {
  cairo_set_source_rgb(cr, 0, 0, 0);
  for (int row = 0; row <= o.target.rows; ++row) {
    for (int col = 0; col <= o.target.cols; ++col) {
      const double left = l.left + col * l.pitch;
      const double bottom = l.bottom - row * l.pitch;
      cairo_rectangle(cr, left - l.gap, bottom, l.gap, l.gap);
      cairo_fill(cr);
      if (row == o.target.rows || col == o.target.cols) continue;
      addTag(cr, l, row * o.target.cols + col, left, bottom, o.border_bits);
    }
  }
}

void drawRuler(cairo_t* cr, const SheetLayout& l, const SheetOptions& o) {
  const double left = l.left - l.gap;
  const double top = l.bottom + l.gap + 5;
  cairo_set_line_width(cr, kRulerLine);
  cairo_move_to(cr, left, top);
  cairo_line_to(cr, left + kRuler, top);
  for (int tick = 0; tick <= 10; ++tick) {
    cairo_move_to(cr, left + 0.1 * kRuler * tick, top);
    cairo_line_to(cr, left + 0.1 * kRuler * tick, top + (tick % 5 == 0 ? 3 : 1.5));
  }
  cairo_stroke(cr);
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, 2.6);
  const std::string lines[2] = {
      "100 mm. If a ruler says otherwise, the print was scaled: multiply tagSize in target.yaml.",
      fmt::format("AprilGrid {} x {}, tag36h11, tagSize {:g} m, tagSpacing {:g}, border {} bits",
                  o.target.cols, o.target.rows, o.target.tag_size, o.target.spacing,
                  o.border_bits)};
  for (int i = 0; i < 2; ++i) {
    cairo_move_to(cr, left, top + 6.5 + 3.5 * i);
    cairo_show_text(cr, lines[i].c_str());
  }
}

void draw(cairo_t* cr, const SheetLayout& l, const SheetOptions& o) {
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  drawTarget(cr, l, o);
  drawRuler(cr, l, o);
}

// Cairo keeps its first fault and draws no more: one question at the end is enough.
void requireDrawn(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw InputError(std::string("the sheet cannot be drawn: ") + cairo_status_to_string(status));
}

}  // namespace

std::optional<PaperSize> paperSizeFrom(const std::string& word) {
  for (const auto& [name, size] : kPapers) {
    if (word == name) return size;
  }
  const auto x = word.find('x');
  if (x == std::string::npos) return std::nullopt;
  const auto width = numberFrom(std::string_view(word).substr(0, x));
  const auto height = numberFrom(std::string_view(word).substr(x + 1));
  if (!width || !height) return std::nullopt;
  return PaperSize{*width, *height};
}

void SheetOptions::check() const {
  if (target.rows < 1 || target.cols < 1 || target.rows > kFamilySize ||
      target.tagCount() > kFamilySize) {
    throw InputError(fmt::format("{} x {} tags: expected 1 to {} in all", target.cols, target.rows,
                                 kFamilySize));
  }
  // As a target.yaml is read.
  if (!(target.tag_size > 0 && target.tag_size <= kLargestTag_m &&
        target.spacing >= kSmallestSpacing && target.spacing <= kLargestSpacing)) {
    throw InputError(fmt::format(
        "the tags need a size of up to {:g} m, and a gap between them of {:g} to {:g} times it",
        kLargestTag_m, kSmallestSpacing, kLargestSpacing));
  }
  if (border_bits != 1 && border_bits != 2)
    throw InputError("the tags' border must have 1 or 2 bits");
  const SheetLayout l = sized(target);
  const double fits = room(l, lying(l, paper));
  if (fits >= 1) return;
  const std::string other =
      room(l, turned(paper)) < 1
          ? "larger paper"
          : fmt::format("paper of {:g} x {:g} mm", paper.height_mm, paper.width_mm);
  throw InputError(fmt::format(
      "the target is {:.0f} x {:.0f} mm with its squares, the paper {:g} x {:g} mm: tags of at "
      "most {:.0f} mm fit, or {} (a margin of {:g} mm and {:g} mm for the ruler are kept)",
      l.width, l.height, paper.width_mm, paper.height_mm, std::floor(l.tag * fits), other, kMargin,
      kStrip));
}

std::string targetSheetPdf(const SheetOptions& options) {
  options.check();
  const SheetLayout l = layoutOf(options);
  std::string pdf;
  const auto append = [](void* to, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  Context page(cairo_pdf_surface_create_for_stream(append, &pdf, kPointsPerMm * l.paper.width_mm,
                                                   kPointsPerMm * l.paper.height_mm));
  cairo_pdf_surface_set_metadata(page.surface, CAIRO_PDF_METADATA_TITLE, "AprilGrid");
  cairo_pdf_surface_set_metadata(page.surface, CAIRO_PDF_METADATA_CREATOR, kSheetMark);
  cairo_scale(page.cr, kPointsPerMm, kPointsPerMm);
  draw(page.cr, l, options);
  cairo_show_page(page.cr);
  requireDrawn(cairo_status(page.cr));
  cairo_surface_finish(page.surface);
  requireDrawn(cairo_surface_status(page.surface));
  return pdf;
}

std::string targetYamlText(const AprilGrid& grid) {
  return fmt::format(
      "# {}\ntarget_type: aprilgrid\ntagCols: {}\ntagRows: {}\ntagSize: {:.10g}     # [m]\n"
      "tagSpacing: {:.10g}   # ratio of the gap to tagSize\n",
      kSheetMark, grid.cols, grid.rows, grid.tag_size, grid.spacing);
}

}  // namespace plumbline
