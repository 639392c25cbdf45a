// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <vtkChartXY.h>
#include <vtkNew.h>

#include "report/plots/plot_data.h"
#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {

struct LegendEntry {
  std::string name;
  Colour colour;
};

/// What a page needs to know before anything is drawn.
struct PageLayout {
  Range x, y;                       ///< what the axes span
  std::vector<LegendEntry> legend;  ///< entries without a name are left out
  bool colour_bar = false;          ///< leave room on the right
};

/// One figure: VTK's chart with its two axes at a place of our choosing, what is drawn in it, and
/// title and legend above. The chart works in units of the axes (0 to 1 from end to end), so that
/// neither the size of the numbers nor a downward axis concerns it; ticks are placed by us.
class ChartPage {
 public:
  ChartPage(const PlotFrame& frame, const PageLayout& layout, const std::string& id);

  ChartPage(const ChartPage&) = delete;  // what is drawn refers to this page
  ChartPage& operator=(const ChartPage&) = delete;

  /// A value on an axis, 0 at its left or lower end and 1 at the other.
  double unitX(double value) const;
  double unitY(double value) const;
  /// Length of the plot area [px].
  double plotWidth() const { return right_ - left_; }
  double plotHeight() const { return top_ - bottom_; }

  void addLine(const Series& series);
  void addBand(const Band& band);
  /// Markers inside the axes only.
  void addPoints(const Series& series);
  /// Each a shape of its own, with its title and link.
  void addNamedPoints(const std::vector<NamedPoint>& points);
  void addPlot(vtkPlot* plot) { chart_->AddPlot(plot); }
  void addDrawing(Drawing drawing);
  void addOutside(Drawing drawing);
  /// The values of a map's cells go into the element, so that pointing at one can tell them.
  void setCells(const HeatMap& map);
  /// Round values beside the colour bar.
  std::vector<AxisTick> colourBarTicks(const Range& range) const;
  /// Colour bar right of the axes for values of `range`, colours from `colourAt` (0 to 1).
  void addColourBar(const Range& range, const std::string& label, Colour (*colourAt)(double));

  /// The key of a vector field in the legend's place: an arrow of `length` (x axis units).
  void addReferenceArrow(double length, const Colour& colour);

  /// Paints twice (VTK settles its axes in the first pass) and returns the element.
  std::string svg();

 private:
  void place(const PageLayout& layout);
  void setUpAxes();
  void setUpAxis(int which, const PlotAxis& axis, const std::vector<AxisTick>& ticks);
  void addHeading(const std::vector<LegendEntry>& legend);
  std::string axisMapping();
  std::string root(const std::string& content);

  PlotFrame frame_;
  std::string id_;
  std::string cells_;  ///< JSON; empty: no map
  Range x_, y_;
  std::vector<AxisTick> x_ticks_, y_ticks_;
  double left_ = 0, right_ = 0, bottom_ = 0, top_ = 0;  // plot area [px], y up
  vtkNew<vtkChartXY> chart_;
  std::vector<vtkSmartPointer<DrawnItem>> outside_;
};

/// vtkContext2D's setters take bytes; these take a Colour.
void setPen(vtkContext2D& painter, const Colour& colour, double width, bool dashed = false);
void setNoPen(vtkContext2D& painter);
void setBrush(vtkContext2D& painter, const Colour& colour);

struct TextStyle {
  int size = 12;  ///< [px]
  bool bold = false;
  Colour colour{64, 70, 80, 255};
  int across = 0;    ///< -1 left, 0 centred, 1 right of the text at the point
  double angle = 0;  ///< counter-clockwise [degree]
};

/// Text centred vertically on the point (in the painter's coordinates).
void drawText(vtkContext2D& painter, double x, double y, const std::string& text,
              const TextStyle& style);

}  // namespace plumbline::internal
