// SPDX-License-Identifier: BSD-3-Clause
// What a chart shows of its series: lines, bands and points.
#include <cmath>

#include <vtkDoubleArray.h>
#include <vtkPen.h>
#include <vtkPlotLine.h>
#include <vtkPlotPoints.h>
#include <vtkSmartPointer.h>
#include <vtkTable.h>

#include "report/plots/vtk/chart_page.h"

namespace plumbline::internal {
namespace {

/// VTK's plots take columns of a table; the chart's axes run from 0 to 1.
vtkSmartPointer<vtkTable> table(const std::vector<double>& x, const std::vector<double>& y) {
  auto result = vtkSmartPointer<vtkTable>::New();
  const std::vector<double>* columns[] = {&x, &y};
  const char* names[] = {"x", "y"};
  for (int k = 0; k < 2; ++k) {
    vtkNew<vtkDoubleArray> column;
    column->SetName(names[k]);
    for (const double value : *columns[k]) column->InsertNextValue(value);
    result->AddColumn(column);
  }
  return result;
}

/// Of lines and of clouds of points, whose diameter is the pen's width.
void style(vtkPlot* plot, const Series& series) {
  const Colour& c = series.colour;
  plot->SetColor(c.red, c.green, c.blue, c.alpha);
  plot->SetWidth(static_cast<float>(series.width));
  plot->GetPen()->SetLineType(series.dashed ? vtkPen::DASH_LINE : vtkPen::SOLID_LINE);
}

}  // namespace

void ChartPage::addLine(const Series& series) {
  std::vector<double> x, y;
  Series lonely = series;  // points without a neighbour to draw a line to
  lonely.x.clear();
  lonely.y.clear();
  // A dot as wide as the line would be overlooked.
  lonely.width = 2.5 * series.width;
  const auto flush = [&](std::size_t end) {
    if (x.size() == 1) {
      lonely.x.push_back(series.x[end - 1]);
      lonely.y.push_back(series.y[end - 1]);
    }
    if (x.size() > 1) {
      vtkNew<vtkPlotLine> line;
      line->SetInputData(table(x, y), 0, 1);
      style(line, series);
      chart_->AddPlot(line);
    }
    x.clear();
    y.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
      x.push_back(unitX(series.x[i]));
      y.push_back(unitY(series.y[i]));
    } else {
      flush(i);
    }
  }
  flush(series.x.size());
  addPoints(lonely);
}

void ChartPage::addBand(const Band& band) {
  addDrawing([this, band](vtkContext2D& painter, SvgDevice&) {
    setNoPen(painter);
    setBrush(painter, band.colour);
    std::vector<float> outline;
    std::vector<std::size_t> piece;
    const auto point = [&](std::size_t i, const std::vector<double>& values) {
      outline.push_back(static_cast<float>(unitX(band.x[i])));
      outline.push_back(static_cast<float>(unitY(values[i])));
    };
    const auto flush = [&] {
      outline.clear();
      // Along the upper edge and back along the lower one.
      for (const std::size_t i : piece) point(i, band.high);
      for (auto i = piece.rbegin(); i != piece.rend(); ++i) point(*i, band.low);
      if (piece.size() > 1) {
        painter.DrawPolygon(outline.data(), static_cast<int>(outline.size() / 2));
      }
      piece.clear();
    };
    for (std::size_t i = 0; i < band.x.size(); ++i) {
      const bool there =
          std::isfinite(band.x[i]) && std::isfinite(band.low[i]) && std::isfinite(band.high[i]);
      if (there) piece.push_back(i);
      if (!there) flush();
    }
    flush();
  });
}

void ChartPage::addPoints(const Series& series) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double u = unitX(series.x[i]);
    const double v = unitY(series.y[i]);
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) continue;  // also drops NaN
    x.push_back(u);
    y.push_back(v);
  }
  if (x.empty()) return;
  vtkNew<vtkPlotPoints> points;
  points->SetInputData(table(x, y), 0, 1);
  points->SetMarkerStyle(vtkPlotPoints::CIRCLE);
  style(points, series);
  points->SetMarkerSize(static_cast<float>(series.width));
  chart_->AddPlot(points);
}

void ChartPage::addNamedPoints(const std::vector<NamedPoint>& points) {
  if (points.empty()) return;
  addDrawing([this, points](vtkContext2D& painter, SvgDevice& device) {
    for (const NamedPoint& point : points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      device.setShapeTitle(point.title);
      device.setShapeLink(point.link);
      // A point is as wide as the pen.
      setPen(painter, point.colour, 7);
      painter.DrawPoint(static_cast<float>(unitX(point.x)), static_cast<float>(unitY(point.y)));
    }
  });
}

}  // namespace plumbline::internal
