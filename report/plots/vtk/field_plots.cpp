// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>
#include <cmath>

#include <vtkContourFilter.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkLookupTable.h>
#include <vtkPlotHistogram2D.h>
#include <vtkPolyData.h>

#include "report/plots/characters.h"
#include "report/plots/svg.h"
#include "report/plots/vtk/chart_page.h"

namespace plumbline {
namespace {

using internal::ChartPage;
using internal::SvgDevice;

constexpr int kColours = 256;
constexpr int kCellLabel = 12;  // [px]

/// Diverging colours have zero in their middle, the others begin with it unless values are below.
Range valueRange(const HeatMap& map) {
  if (map.value_range) return *map.value_range;
  Range range = rangeOf({&map.values}, 0);
  if (map.colours == ColourMap::kDiverging) {
    const double largest = std::max(std::abs(range.min), std::abs(range.max));
    return {-largest, largest};
  }
  // From 0, so that of two magnitudes the colours tell how many times one is the other.
  if (range.min > 0) range.min = 0;
  return range;
}

/// The map's values into an image of the same size, whose rows go up.
void fillScalars(const HeatMap& map, vtkImageData& image) {
  image.AllocateScalars(VTK_DOUBLE, 1);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) +
                     static_cast<std::size_t>(column);
      // A map's first row is its top, an image's its bottom.
      *static_cast<double*>(image.GetScalarPointer(column, map.rows - 1 - row, 0)) = map.values[i];
    }
  }
}

vtkSmartPointer<vtkPlotHistogram2D> cells(const HeatMap& map, const Range& range,
                                          Colour (*colourAt)(double)) {
  vtkNew<vtkLookupTable> colours;
  colours->SetNumberOfTableValues(kColours);
  // Values beyond the range have the colour of its end.
  colours->SetRange(range.min, range.max);
  for (int i = 0; i < kColours; ++i) {
    const Colour c = colourAt(i / (kColours - 1.0));
    colours->SetTableValue(i, c.red / 255.0, c.green / 255.0, c.blue / 255.0, 1);
  }
  // Where there is no value the page shows through.
  colours->SetNanColor(1, 1, 1, 0);
  colours->BuildSpecialColors();
  vtkNew<vtkImageData> image;
  image->SetDimensions(map.columns, map.rows, 1);
  image->SetSpacing(1.0 / map.columns, 1.0 / map.rows, 1);
  fillScalars(map, *image);
  auto plot = vtkSmartPointer<vtkPlotHistogram2D>::New();
  plot->SetInputData(image);
  plot->SetTransferFunction(colours);
  return plot;
}

/// What cannot be read is left out: pointing at the cell tells it.
bool fits(const std::string& label, const ChartPage& page, const HeatMap& map) {
  constexpr double kCharacter = 6.6;  // width of a digit; a point is half of it [px]
  const auto points = static_cast<double>(std::ranges::count(label, '.'));
  const double wide = static_cast<double>(internal::characterCount(label)) - 0.5 * points;
  return kCharacter * wide < page.plotWidth() / map.columns &&
         kCellLabel + 2 < page.plotHeight() / map.rows;
}

/// In black or white, by which the colour of the cell lets it be read.
void drawCellLabels(vtkContext2D& painter, const ChartPage& page, const HeatMap& map,
                    const Range& range) {
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) +
                     static_cast<std::size_t>(column);
      if (map.cell_labels[i].empty() || !fits(map.cell_labels[i], page, map)) continue;
      const double unit = (map.values[i] - range.min) / (range.max - range.min);
      // Sequential colours are dark at their low end, diverging ones at both.
      const bool dark =
          map.colours == ColourMap::kDiverging ? std::abs(unit - 0.5) > 0.36 : unit < 0.5;
      const Colour ink = dark ? Colour{255, 255, 255, 255} : Colour{24, 28, 34, 255};
      internal::drawText(painter, (column + 0.5) / map.columns, 1 - (row + 0.5) / map.rows,
                         map.cell_labels[i], {.size = kCellLabel, .colour = ink});
    }
  }
}

/// Lines through the centres of cells (in units of the axes) where the value is that of a tick.
void drawContours(vtkContext2D& painter, const HeatMap& map, const std::vector<AxisTick>& levels) {
  vtkNew<vtkImageData> centres;
  centres->SetDimensions(map.columns, map.rows, 1);
  centres->SetSpacing(1.0 / map.columns, 1.0 / map.rows, 1);
  centres->SetOrigin(0.5 / map.columns, 0.5 / map.rows, 0);
  fillScalars(map, *centres);
  vtkNew<vtkContourFilter> filter;
  filter->SetInputData(centres);
  int level = 0;
  for (const AxisTick& tick : levels) filter->SetValue(level++, tick.position);
  filter->Update();
  internal::setPen(painter, {255, 255, 255, 200}, 1);
  vtkPolyData* lines = filter->GetOutput();
  const vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < lines->GetNumberOfCells(); ++i) {
    lines->GetCellPoints(i, ids);
    std::vector<float> points;
    for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k) {
      const double* p = lines->GetPoint(ids->GetId(k));
      if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;  // beside a blank cell
      points.push_back(static_cast<float>(p[0]));
      points.push_back(static_cast<float>(p[1]));
    }
    // A contour that lost all points but one is none.
    if (points.size() > 2) painter.DrawPoly(points.data(), static_cast<int>(points.size() / 2));
  }
}

/// An arrow from foot to tip, both in axis units; the head is a fixed share of its length.
void drawArrow(vtkContext2D& painter, const ChartPage& page, const FieldArrow& arrow,
               double magnification) {
  const double dx = arrow.dx * magnification;
  const double dy = arrow.dy * magnification;
  const double x = arrow.x + dx;
  const double y = arrow.y + dy;
  // Of the arrow's length, along it; half as much to either side.
  constexpr double kHead = 0.3;
  const double corners[5][2] = {{arrow.x, arrow.y},
                                {x, y},
                                {x - kHead * (dx + 0.5 * dy), y - kHead * (dy - 0.5 * dx)},
                                {x, y},
                                {x - kHead * (dx - 0.5 * dy), y - kHead * (dy + 0.5 * dx)}};
  std::vector<float> line;
  for (const auto& corner : corners) {
    line.push_back(static_cast<float>(page.unitX(corner[0])));
    line.push_back(static_cast<float>(page.unitY(corner[1])));
  }
  painter.DrawPoly(line.data(), 5);
}

}  // namespace

std::string toSvg(const HeatMap& map, const std::string& id) {
  assert(map.frame.x.range && map.frame.y.range && map.columns > 0 && map.rows > 0);
  const Range range = valueRange(map);
  auto* colourAt = map.colours == ColourMap::kDiverging ? &internal::divergingColour
                                                        : &internal::sequentialColour;
  ChartPage page(map.frame, {*map.frame.x.range, *map.frame.y.range, {}, true}, id);
  page.addPlot(cells(map, range, colourAt));
  if (!map.cell_labels.empty()) {
    page.addDrawing(
        [&](vtkContext2D& painter, SvgDevice&) { drawCellLabels(painter, page, map, range); });
  }
  if (map.contours) {
    page.addDrawing([&](vtkContext2D& painter, SvgDevice&) {
      drawContours(painter, map, page.colourBarTicks(range));
    });
  }
  page.setCells(map);
  page.addColourBar(range, map.value_label, colourAt);
  return page.svg();
}

std::string toSvg(const VectorField& plot, const std::string& id) {
  std::vector<double> xs, ys;
  for (const FieldArrow& arrow : plot.arrows) {
    xs.push_back(arrow.x);
    ys.push_back(arrow.y);
  }
  internal::PageLayout layout;
  layout.x = plot.frame.x.range.value_or(rangeOf({&xs}, 0.05));
  layout.y = plot.frame.y.range.value_or(rangeOf({&ys}, 0.05));
  // A transparent swatch: the arrow of addReferenceArrow() takes its place.
  if (plot.reference > 0) layout.legend.push_back({plot.reference_label, {255, 255, 255, 0}});
  ChartPage page(plot.frame, layout, id);
  page.addDrawing([&page, &plot](vtkContext2D& painter, SvgDevice& device) {
    for (const FieldArrow& arrow : plot.arrows) {
      if (!std::isfinite(arrow.dx) || !std::isfinite(arrow.dy)) continue;
      device.setShapeTitle(arrow.note);
      // A cut arrow keeps its direction, and its note tells the true length.
      const double length = std::hypot(arrow.dx, arrow.dy);
      const bool cut = plot.longest > 0 && length > plot.longest;
      internal::setPen(painter, cut ? kWarningColour : plot.colour, 1.2);
      drawArrow(painter, page, arrow, plot.magnification * (cut ? plot.longest / length : 1));
    }
  });
  if (plot.reference > 0) {
    page.addReferenceArrow(plot.reference * plot.magnification, plot.colour);
  }
  return page.svg();
}

}  // namespace plumbline
