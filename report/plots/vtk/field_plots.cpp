// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>
#include <cmath>

#include <vtkImageData.h>
#include <vtkLookupTable.h>
#include <vtkPlotHistogram2D.h>

#include "report/plots/colour_maps.h"
#include "report/plots/svg.h"
#include "report/plots/ticks.h"
#include "report/plots/vtk/chart_page.h"

namespace plumbline {
namespace {

using internal::ChartPage;
using internal::SvgDevice;

constexpr int kColours = 256;

Range valueRange(const HeatMap& map) {
  if (map.value_range) return *map.value_range;
  Range range = rangeOf({&map.values}, 0);
  if (map.colours == ColourMap::kDiverging) {
    const double largest = std::max(std::abs(range.min), std::abs(range.max));
    return {-largest, largest};
  }
  if (range.min > 0) range.min = 0;
  return range;
}

vtkSmartPointer<vtkPlotHistogram2D> cells(const HeatMap& map, const Range& range,
                                          Colour (*colourAt)(double)) {
  vtkNew<vtkLookupTable> colours;
  colours->SetNumberOfTableValues(kColours);
  colours->SetRange(range.min, range.max);
  for (int i = 0; i < kColours; ++i) {
    const Colour c = colourAt(i / (kColours - 1.0));
    colours->SetTableValue(i, c.red / 255.0, c.green / 255.0, c.blue / 255.0, 1);
  }
  colours->SetNanColor(1, 1, 1, 0);
  colours->BuildSpecialColors();
  vtkNew<vtkImageData> image;
  image->SetDimensions(map.columns, map.rows, 1);
  image->SetSpacing(1.0 / map.columns, 1.0 / map.rows, 1);
  image->AllocateScalars(VTK_DOUBLE, 1);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) +
                     static_cast<std::size_t>(column);
      *static_cast<double*>(image->GetScalarPointer(column, map.rows - 1 - row, 0)) = map.values[i];
    }
  }
  auto plot = vtkSmartPointer<vtkPlotHistogram2D>::New();
  plot->SetInputData(image);
  plot->SetTransferFunction(colours);
  return plot;
}

void drawCellLabels(vtkContext2D& painter, const HeatMap& map, const Range& range) {
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) +
                     static_cast<std::size_t>(column);
      if (map.cell_labels[i].empty()) continue;
      const double unit = (map.values[i] - range.min) / (range.max - range.min);
      const bool dark =
          map.colours == ColourMap::kDiverging ? std::abs(unit - 0.5) > 0.36 : unit > 0.55;
      const Colour ink = dark ? Colour{255, 255, 255, 255} : Colour{50, 55, 62, 255};
      internal::drawText(painter, (column + 0.5) / map.columns, 1 - (row + 0.5) / map.rows,
                         map.cell_labels[i], {.size = 9, .colour = ink});
    }
  }
}

/// An arrow from foot to tip, both in axis units; the head is a fixed share of its length.
void drawArrow(vtkContext2D& painter, const ChartPage& page, const FieldArrow& arrow,
               double magnification) {
  const double dx = arrow.dx * magnification;
  const double dy = arrow.dy * magnification;
  const double x = arrow.x + dx;
  const double y = arrow.y + dy;
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
        [&map, range](vtkContext2D& painter, SvgDevice&) { drawCellLabels(painter, map, range); });
  }
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
  if (plot.reference > 0) layout.legend.push_back({plot.reference_label, {255, 255, 255, 0}});
  ChartPage page(plot.frame, layout, id);
  page.addDrawing([&page, &plot](vtkContext2D& painter, SvgDevice& device) {
    internal::setPen(painter, plot.colour, 1.2);
    for (const FieldArrow& arrow : plot.arrows) {
      if (!std::isfinite(arrow.dx) || !std::isfinite(arrow.dy)) continue;
      device.setShapeTitle(arrow.note);
      drawArrow(painter, page, arrow, plot.magnification);
    }
  });
  if (plot.reference > 0) {
    page.addReferenceArrow(plot.reference * plot.magnification, plot.colour);
  }
  return page.svg();
}

}  // namespace plumbline
