// SPDX-License-Identifier: BSD-3-Clause
#include "report/plots/vtk/chart_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vtkAxis.h>
#include <vtkBrush.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkPen.h>
#include <vtkStringArray.h>
#include <vtkTextProperty.h>

#include "report/plots/characters.h"
#include "report/plots/svg.h"
#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {
namespace {

constexpr double kCharacter = 6.65;  // width of a tick label's character at 12 px [px]
// The same of a name: letters of a wide font (DejaVu Sans), where labels of digits have slack.
constexpr double kLetter = 7.2;
constexpr double kTitleBand = 26;   // [px]
constexpr double kLegendBand = 20;  // [px]
constexpr double kColourBar = 86;   // room for bar, its labels and title [px]
constexpr double kMargin = 14;      // around everything [px]
constexpr Colour kInk{64, 70, 80, 255};
// zoom.js finds the lines of the grid by this colour.
constexpr Colour kGrid{228, 231, 236, 255};
constexpr Colour kFrame{150, 156, 166, 255};

/// By the length of the words: the page's font is the browser's, and measuring another would not
/// help.
double widestLabel(const std::vector<AxisTick>& ticks, double character = kCharacter) {
  std::size_t longest = 1;
  for (const AxisTick& tick : ticks) longest = std::max(longest, characterCount(tick.label));
  return character * static_cast<double>(longest);
}

}  // namespace

void setPen(vtkContext2D& painter, const Colour& colour, double width, bool dashed) {
  painter.GetPen()->SetColor(colour.red, colour.green, colour.blue, colour.alpha);
  painter.GetPen()->SetWidth(static_cast<float>(width));
  painter.GetPen()->SetLineType(dashed ? vtkPen::DASH_LINE : vtkPen::SOLID_LINE);
}

void setNoPen(vtkContext2D& painter) { painter.GetPen()->SetLineType(vtkPen::NO_PEN); }

void setBrush(vtkContext2D& painter, const Colour& colour) {
  painter.GetBrush()->SetColor(colour.red, colour.green, colour.blue, colour.alpha);
}

void drawText(vtkContext2D& painter, double x, double y, const std::string& text,
              const TextStyle& text_style) {
  vtkNew<vtkTextProperty> property;
  property->SetFontSize(text_style.size);
  property->SetBold(text_style.bold);
  property->SetColor(text_style.colour.red / 255.0, text_style.colour.green / 255.0,
                     text_style.colour.blue / 255.0);
  property->SetJustification(text_style.across < 0    ? VTK_TEXT_LEFT
                             : text_style.across == 0 ? VTK_TEXT_CENTERED
                                                      : VTK_TEXT_RIGHT);
  property->SetVerticalJustificationToCentered();
  property->SetOrientation(text_style.angle);
  painter.ApplyTextProp(property);
  painter.DrawString(static_cast<float>(x), static_cast<float>(y), text);
}

ChartPage::ChartPage(const PlotFrame& frame, const PageLayout& layout, const std::string& id)
    : frame_(frame), id_(id), x_(layout.x), y_(layout.y) {
  // A tick for about every 90 px across and 55 px up: room for its label, and air.
  const int x_target = std::max(2, frame.width / 90);
  const int y_target = std::max(2, frame.height / 55);
  x_ticks_ = frame.x.ticks.empty() ? roundTicks(x_, x_target) : frame.x.ticks;
  y_ticks_ = frame.y.ticks.empty() ? roundTicks(y_, y_target) : frame.y.ticks;
  place(layout);
  setUpAxes();
  addHeading(layout.legend);
  addDrawing([](vtkContext2D&, SvgDevice& device) { device.startData(); });  // after the grid
}

// A range has a length: one from the data by rangeOf(), one that was given by its caller.
double ChartPage::unitX(double value) const { return (value - x_.min) / (x_.max - x_.min); }

double ChartPage::unitY(double value) const {
  // VTK's axis always runs upwards: of an inverted one the values are turned.
  const double unit = (value - y_.min) / (y_.max - y_.min);
  return frame_.y.inverted ? 1 - unit : unit;
}

void ChartPage::place(const PageLayout& layout) {
  const bool legend =
      std::ranges::any_of(layout.legend, [](const LegendEntry& e) { return !e.name.empty(); });
  const double x_labels = frame_.x.upright_labels ? widestLabel(x_ticks_, kLetter) : 14;
  // Whole pixels, as VTK hands on clips in integers.
  // From the edge inwards: margin, the axis' title, the widest label, its distance from the axis.
  left_ = std::ceil(kMargin + (frame_.y.label.empty() ? 0 : 16) + widestLabel(y_ticks_) + 10);
  right_ = std::floor(frame_.width - kMargin - (layout.colour_bar ? kColourBar : 6));
  bottom_ = std::ceil(kMargin + (frame_.x.label.empty() ? 0 : 18) + x_labels + 6);
  top_ = std::floor(frame_.height - (frame_.title.empty() ? kMargin : kTitleBand + 6) -
                    (legend ? kLegendBand : 0));
  if (!frame_.equal_axes) return;
  const double x_scale = plotWidth() / (x_.max - x_.min);
  const double y_scale = plotHeight() / (y_.max - y_.min);
  // The axis that has room to spare is shortened; its place at the left and at the top stays.
  const double scale = std::min(x_scale, y_scale);
  // Of the two this one or the next stays where it is, but for rounding.
  right_ = left_ + std::round(scale * (x_.max - x_.min));
  bottom_ = top_ - std::round(scale * (y_.max - y_.min));
}

void ChartPage::setUpAxis(int which, const PlotAxis& axis, const std::vector<AxisTick>& ticks) {
  const bool horizontal = which == vtkAxis::BOTTOM;
  vtkNew<vtkDoubleArray> positions;
  vtkNew<vtkStringArray> labels;
  for (const AxisTick& tick : ticks) {
    const double unit = horizontal ? unitX(tick.position) : unitY(tick.position);
    // A tick at an end of the axis may be a rounding beyond it.
    if (unit < -1e-9 || unit > 1 + 1e-9) continue;
    positions->InsertNextValue(std::clamp(unit, 0.0, 1.0));
    labels->InsertNextValue(tick.label);
  }
  vtkAxis* vtk_axis = chart_->GetAxis(which);
  vtk_axis->SetBehavior(vtkAxis::FIXED);
  vtk_axis->SetRange(0, 1);
  vtk_axis->SetCustomTickPositions(positions, labels);
  vtk_axis->SetTitle("");
  vtk_axis->SetLabelsVisible(false);  // drawn beside the chart, where their place is ours
  vtk_axis->SetTickLength(4);
  vtk_axis->GetPen()->SetColor(kFrame.red, kFrame.green, kFrame.blue);
  vtk_axis->GetGridPen()->SetColor(kGrid.red, kGrid.green, kGrid.blue);
  addOutside([this, horizontal, axis, ticks](vtkContext2D& painter, SvgDevice& device) {
    // zoom.js finds the labels that it has to move by these classes.
    device.setTextClass(horizontal ? "tx" : "ty");
    for (const AxisTick& tick : ticks) {
      const double unit = horizontal ? unitX(tick.position) : unitY(tick.position);
      if (unit < -1e-9 || unit > 1 + 1e-9) continue;
      if (!horizontal) {
        drawText(painter, left_ - 8, bottom_ + unit * plotHeight(), tick.label, {.across = 1});
      } else if (axis.upright_labels) {
        drawText(painter, left_ + unit * plotWidth(), bottom_ - 8, tick.label,
                 {.across = 1, .angle = 90});
      } else {
        drawText(painter, left_ + unit * plotWidth(), bottom_ - 15, tick.label, {});
      }
    }
    device.setTextClass("");
    if (axis.label.empty()) return;
    const TextStyle title{.size = 12, .colour = kInk};
    const double middle_y = (bottom_ + top_) / 2;
    if (!horizontal) {
      TextStyle turned = title;
      turned.angle = 90;
      // Beside the widest label of all ticks, those that are left out too: place() made room so.
      drawText(painter, left_ - widestLabel(ticks) - 20, middle_y, axis.label, turned);
    } else {
      const double labels_height = axis.upright_labels ? widestLabel(ticks, kLetter) : 14;
      drawText(painter, (left_ + right_) / 2, bottom_ - labels_height - 18, axis.label, title);
    }
  });
}

void ChartPage::setUpAxes() {
  chart_->SetAutoSize(false);
  chart_->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
  chart_->SetSize(vtkRectf(static_cast<float>(left_), static_cast<float>(bottom_),
                           static_cast<float>(plotWidth()), static_cast<float>(plotHeight())));
  chart_->SetShowLegend(false);
  // Otherwise VTK leaves a border at the sides without an axis, and the plot is not where place()
  // has put it.
  chart_->SetHiddenAxisBorder(0);
  setUpAxis(vtkAxis::BOTTOM, frame_.x, x_ticks_);
  setUpAxis(vtkAxis::LEFT, frame_.y, y_ticks_);
}

void ChartPage::addHeading(const std::vector<LegendEntry>& legend) {
  addOutside([this, legend](vtkContext2D& painter, SvgDevice&) {
    double y = frame_.height - 18;
    if (!frame_.title.empty()) {
      drawText(painter, kMargin, y, frame_.title,
               {.size = 13, .bold = true, .colour = {32, 38, 46, 255}, .across = -1});
      y -= kLegendBand + 2;
    }
    // From the axes' left end, one entry after the other; there is no second row.
    double x = left_;
    for (const LegendEntry& entry : legend) {
      if (entry.name.empty()) continue;
      setNoPen(painter);
      setBrush(painter, entry.colour);
      painter.DrawRect(static_cast<float>(x), static_cast<float>(y - 2), 14, 4);
      drawText(painter, x + 20, y, entry.name, {.across = -1});
      x += 36 + kCharacter * static_cast<double>(characterCount(entry.name));
    }
  });
}

void ChartPage::addDrawing(Drawing drawing) {
  vtkNew<DrawnPlot> plot;
  plot->drawing = std::move(drawing);
  chart_->AddPlot(plot);
}

void ChartPage::addOutside(Drawing drawing) {
  auto item = vtkSmartPointer<DrawnItem>::New();
  item->drawing = std::move(drawing);
  outside_.push_back(item);
}

std::vector<AxisTick> ChartPage::colourBarTicks(const Range& range) const {
  return roundTicks(range, std::max(2, static_cast<int>(plotHeight() / 50)));
}

void ChartPage::addColourBar(const Range& range, const std::string& label,
                             Colour (*colourAt)(double)) {
  addOutside([this, range, label, colourAt](vtkContext2D& painter, SvgDevice&) {
    constexpr int kSteps = 48;
    const double x = right_ + 14;
    const double step = plotHeight() / kSteps;
    setNoPen(painter);
    for (int i = 0; i < kSteps; ++i) {
      setBrush(painter, colourAt((i + 0.5) / kSteps));
      // A little more than a step, so that no seam shows between two.
      painter.DrawRect(static_cast<float>(x), static_cast<float>(bottom_ + i * step), 12,
                       static_cast<float>(step + 0.3));
    }
    const auto ticks = colourBarTicks(range);
    for (const AxisTick& tick : ticks) {
      const double unit = (tick.position - range.min) / (range.max - range.min);
      drawText(painter, x + 17, bottom_ + unit * plotHeight(), tick.label, {.across = -1});
    }
    drawText(painter, x + 26 + widestLabel(ticks), (bottom_ + top_) / 2, label,
             {.size = 12, .colour = kInk, .angle = 90});
  });
}

void ChartPage::setCells(const HeatMap& map) {
  const auto names = [](const std::vector<AxisTick>& ticks) {
    nlohmann::json list = nlohmann::json::array();
    for (const AxisTick& tick : ticks) list.push_back(tick.label);
    return list;
  };
  nlohmann::json values = nlohmann::json::array();
  for (const double v : map.values) {  // four digits; null where there is nothing
    values.push_back(std::isfinite(v) ? nlohmann::json::parse(fmt::format("{:.4g}", v)) : nullptr);
  }
  nlohmann::json cells{
      {"columns", map.columns}, {"rows", map.rows}, {"label", map.value_label}, {"values", values}};
  // Ticks name the cells only where there is one for each.
  if (map.frame.x.ticks.size() == static_cast<std::size_t>(map.columns)) {
    cells["x"] = names(map.frame.x.ticks);
  }
  if (map.frame.y.ticks.size() == static_cast<std::size_t>(map.rows)) {
    cells["y"] = names(map.frame.y.ticks);
  }
  cells_ = " data-cells=\"" + escapeXml(cells.dump()) + "\"";
}

void ChartPage::addReferenceArrow(double length, const Colour& colour) {
  addOutside([this, length, colour](vtkContext2D& painter, SvgDevice&) {
    // It ends where the legend's swatch does, which is transparent, and grows to the left: the
    // words after it stay where they are.
    const auto x1 = static_cast<float>(left_ + 14);
    const auto x0 = static_cast<float>(x1 - length * plotWidth() / (x_.max - x_.min));
    const auto y = static_cast<float>(top_ + 12);
    const auto head = 0.3F * (x1 - x0);
    setPen(painter, colour, 1.4);
    painter.DrawLine(x0, y, x1, y);
    painter.DrawLine(x1, y, x1 - head, y + head / 2);
    painter.DrawLine(x1, y, x1 - head, y - head / 2);
  });
}

/// For the page's scripts: the values at the ends of both axes, and where these are in the element
/// [px, y down], as VTK has placed them.
std::string ChartPage::axisMapping() {
  vtkAxis* x = chart_->GetAxis(vtkAxis::BOTTOM);
  vtkAxis* y = chart_->GetAxis(vtkAxis::LEFT);
  const double height = frame_.height;
  const bool inverted = frame_.y.inverted;
  return fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {} {} {} {}", x_.min, x_.max,
                     inverted ? y_.max : y_.min, inverted ? y_.min : y_.max,
                     pixel(x->GetPoint1()[0]), pixel(x->GetPoint2()[0]),
                     pixel(height - y->GetPoint1()[1]), pixel(height - y->GetPoint2()[1]));
}

std::string ChartPage::root(const std::string& content) {
  std::string values;
  if (frame_.x.log10) values += 'x';
  if (frame_.y.log10) values += 'y';
  if (!values.empty()) values = " data-log=\"" + values + '"';
  if (frame_.y.highest) values += fmt::format(" data-highest=\"{:.9g}\"", *frame_.y.highest);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" id=\"{}\" viewBox=\"0 0 {} {}\" "
      "width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"{}\" data-ax=\"{}\"{}{} "
      "font-family=\"Inter,'Helvetica Neue',Arial,'Liberation Sans',sans-serif\">{}</svg>",
      id_, frame_.width, frame_.height, frame_.width, frame_.height, escapeXml(frame_.title),
      axisMapping(), values, cells_, content);
}

std::string ChartPage::svg() {
  vtkNew<vtkContextScene> scene;
  scene->AddItem(chart_);
  for (const auto& item : outside_) scene->AddItem(item);
  scene->SetGeometry(frame_.width, frame_.height);
  vtkNew<SvgDevice> device;
  vtkNew<vtkContext2D> painter;
  // VTK's axes find their place with the first painting; start() drops what that one drew.
  for (int pass = 0; pass < 2; ++pass) {
    device->start(id_, frame_.height);
    painter->Begin(device);
    scene->Paint(painter);
    painter->End();
  }
  return root(device->content());
}

}  // namespace plumbline::internal
