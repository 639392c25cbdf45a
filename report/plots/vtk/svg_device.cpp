// SPDX-License-Identifier: BSD-3-Clause
#include "report/plots/vtk/svg_device.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkRect.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <vtkUnsignedCharArray.h>

#include "calibrator/base/transform.h"
#include "report/plots/base64.h"

namespace plumbline::internal {
namespace {

constexpr int kDotsPerInch = 72;  // then a point is a pixel

std::string hexColour(const unsigned char* rgb) {
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string opacity(const char* name, unsigned char alpha) {
  return alpha == 255 ? "" : fmt::format(" {}=\"{:.3g}\"", name, alpha / 255.0);
}

/// The image as a PNG in a data URI. VTK's rows run upwards; the writer turns them.
std::string pngUri(vtkImageData* image) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return "data:image/png;base64," + base64({reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                            static_cast<std::size_t>(bytes->GetNumberOfValues())});
}

/// A scene may be painted to other devices, which know no titles: nothing is drawn there.
bool paint(const Drawing& drawing, vtkContext2D* painter) {
  auto* device = dynamic_cast<SvgDevice*>(painter->GetDevice());
  if (!drawing || !device) return false;
  drawing(*painter, *device);
  // What is drawn next is another's, and has no title of this one's.
  device->setShapeTitle("");
  device->setShapeLink("");
  return true;
}

}  // namespace

vtkStandardNewMacro(SvgDevice);
vtkStandardNewMacro(DrawnPlot);
vtkStandardNewMacro(DrawnItem);

void SvgDevice::start(const std::string& id, double height) {
  id_ = id;
  height_ = height;
  defs_.clear();
  body_.clear();
  shape_title_.clear();
  shape_link_.clear();
  text_class_.clear();
  stack_.clear();
  matrix_ = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  clip_count_ = 0;
  clip_open_ = false;
  in_data_ = false;
}

std::string SvgDevice::content() const {
  const std::string defs = defs_.empty() ? "" : "<defs>" + defs_ + "</defs>";
  return defs + "<g fill=\"none\" stroke=\"none\">" + body_ + (clip_open_ ? "</g>" : "") + "</g>";
}

std::vector<double> SvgDevice::toPage(const float* points, int n) const {
  std::vector<double> page;
  page.reserve(2 * static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double x = points[2 * i];
    const double y = points[2 * i + 1];
    page.push_back(matrix_[0] * x + matrix_[1] * y + matrix_[2]);
    // VTK counts from the bottom, SVG from the top.
    page.push_back(height_ - (matrix_[3] * x + matrix_[4] * y + matrix_[5]));
  }
  // All or nothing: NaN is no number of SVG's, and what a browser makes of it is its own.
  const bool finite = std::ranges::all_of(page, [](double v) { return std::isfinite(v); });
  return finite ? page : std::vector<double>();
}

void SvgDevice::element(const std::string& shape, const std::string& attributes) {
  if (!shape_link_.empty()) body_ += "<a href=\"" + escapeXml(shape_link_) + "\">";
  body_ += '<' + shape + ' ' + attributes;
  if (shape_title_.empty()) {
    body_ += "/>";
  } else {
    body_ += "><title>" + escapeXml(shape_title_) + "</title></" + shape + '>';
  }
  if (!shape_link_.empty()) body_ += "</a>";
}

// Hundredths of a pixel for data, into which readers zoom and which they save as CSV; tenths for
// all else, and where the text would grow.
std::string (*SvgDevice::writer(const std::vector<double>& page) const)(double) {
  constexpr std::size_t kFew = 10'000;  // points: more would make the page large
  return in_data_ && page.size() / 2 <= kFew ? &finePixel : &pixel;
}

std::string SvgDevice::strokeAttributes() const {
  const vtkColor4ub colour = Pen->GetColorObject();
  const unsigned char* rgba = colour.GetData();
  if (Pen->GetLineType() == vtkPen::NO_PEN || rgba[3] == 0) return "";
  return fmt::format(" stroke=\"{}\" stroke-width=\"{:.3g}\"{}{}", hexColour(rgba),
                     // Half a pixel at least: thinner lines are hardly seen.
                     std::max(0.5F, Pen->GetWidth()), opacity("stroke-opacity", rgba[3]),
                     // In pixels, whatever the width of the line.
                     Pen->GetLineType() == vtkPen::DASH_LINE ? " stroke-dasharray=\"6 4\"" : "");
}

std::string SvgDevice::fillAttributes() const {
  const vtkColor4ub colour = Brush->GetColorObject();
  const unsigned char* rgba = colour.GetData();
  if (rgba[3] == 0) return "";
  return fmt::format(" fill=\"{}\"{}", hexColour(rgba), opacity("fill-opacity", rgba[3]));
}

void SvgDevice::DrawPoly(float* points, int n, unsigned char*, int) {
  const std::vector<double> page = thinLine(toPage(points, n));
  const std::string stroke = strokeAttributes();
  if (page.empty() || stroke.empty()) return;
  element("polyline",
          fmt::format("{}points=\"{}\"{} stroke-linejoin=\"round\"",
                      in_data_ ? "class=\"data\" " : "", pointList(page, writer(page)), stroke));
}

void SvgDevice::DrawLines(float* points, int n, unsigned char*, int) {
  const std::vector<double> page = toPage(points, n);
  const std::string stroke = strokeAttributes();
  if (page.empty() || stroke.empty()) return;
  std::string path;
  // Two points make a line of their own.
  for (std::size_t i = 0; i + 3 < page.size(); i += 4) {
    path += 'M' + pixel(page[i]) + ' ' + pixel(page[i + 1]) + 'L' + pixel(page[i + 2]) + ' ' +
            pixel(page[i + 3]);
  }
  element("path", fmt::format("d=\"{}\"{}", path, stroke));
}

void SvgDevice::DrawMarkers(int, bool highlight, float* points, int n, unsigned char*, int) {
  const std::vector<double> page = toPage(points, n);
  const std::string stroke = strokeAttributes();
  // Highlights are of a selection, which a page does not have.
  if (highlight || page.empty() || stroke.empty()) return;
  auto* const write = writer(page);
  std::string path;
  path.reserve(page.size() * 6);
  for (std::size_t i = 0; i + 1 < page.size(); i += 2) {
    // A closed path without length: its round caps make a dot.
    path += 'M' + write(page[i]) + ' ' + write(page[i + 1]) + 'z';
  }
  element("path", fmt::format("class=\"pts\" d=\"{}\"{} stroke-linecap=\"round\"", path, stroke));
}

/// A strip has its corners in zigzag, a polygon around: the last two change places.
void SvgDevice::DrawQuadStrip(float* points, int n) {
  for (int i = 0; i + 3 < n; i += 2) {
    const float* p = points + 2 * i;
    float quad[8] = {p[0], p[1], p[2], p[3], p[6], p[7], p[4], p[5]};
    DrawPolygon(quad, 4);
  }
}

void SvgDevice::DrawPolygon(float* points, int n) {
  const std::vector<double> page = toPage(points, n);
  const std::string fill = fillAttributes();
  if (page.empty() || fill.empty()) return;
  element("polygon", fmt::format("{}points=\"{}\"{}", in_data_ ? "class=\"data\" " : "",
                                 pointList(page, writer(page)), fill));
}

void SvgDevice::DrawEllipticArc(float x, float y, float radius_x, float radius_y, float start_angle,
                                float stop_angle) {
  // Pieces of 7.5 degrees at most, whose corners nobody sees at the size of a plot's symbols.
  constexpr int kSteps = 48;
  std::vector<float> points;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = (start_angle + (stop_angle - start_angle) * i / kSteps) * kDegree;
    points.push_back(x + radius_x * static_cast<float>(std::cos(angle)));
    points.push_back(y + radius_y * static_cast<float>(std::sin(angle)));
  }
  DrawPolygon(points.data(), kSteps + 1);
  DrawPoly(points.data(), kSteps + 1, nullptr, 0);
}

void SvgDevice::DrawString(float* point, const vtkStdString& text) {
  const std::vector<double> page = toPage(point, 1);
  if (text.empty() || page.empty()) return;
  double rgb[3];
  TextProp->GetColor(rgb);
  unsigned char bytes[3];
  for (int i = 0; i < 3; ++i) bytes[i] = static_cast<unsigned char>(std::lround(rgb[i] * 255));
  const int across = TextProp->GetJustification();
  const int along = TextProp->GetVerticalJustification();
  const char* anchor = across == VTK_TEXT_RIGHT      ? "end"
                       : across == VTK_TEXT_CENTERED ? "middle"
                                                     : "start";
  // From the baseline, in sizes of the font: what of the text is put on the point.
  const char* shift = along == VTK_TEXT_TOP        ? "0.8em"
                      : along == VTK_TEXT_CENTERED ? "0.33em"
                                                   : "-0.15em";
  const double angle = TextProp->GetOrientation();
  // VTK turns counter-clockwise, SVG clockwise.
  const std::string turn = angle == 0 ? "" : fmt::format(" rotate({:g})", -angle);
  body_ += fmt::format(
      "<text{} transform=\"translate({},{}){}\" dy=\"{}\" text-anchor=\"{}\" font-size=\"{}\" "
      "fill=\"{}\"{}>{}</text>",
      text_class_.empty() ? "" : " class=\"" + text_class_ + '"', pixel(page[0]), pixel(page[1]),
      turn, shift, anchor, TextProp->GetFontSize(), hexColour(bytes),
      TextProp->GetBold() ? " font-weight=\"600\"" : "", escapeXml(text));
}

void SvgDevice::ComputeStringBounds(const vtkStdString& text, float bounds[4]) {
  std::fill(bounds, bounds + 4, 0.0F);
  vtkTextRenderer* renderer = vtkTextRenderer::GetInstance();
  int box[4] = {0, 0, 0, 0};
  if (text.empty() || !renderer ||
      !renderer->GetBoundingBox(TextProp, text, box, kDotsPerInch, vtkTextRenderer::FreeType)) {
    return;
  }
  // In units of the item that asks, as VTK wants bounds.
  // The matrix of these charts scales and shifts, and neither turns nor shears.
  const double sx = std::abs(matrix_[0]);
  const double sy = std::abs(matrix_[4]);
  bounds[0] = static_cast<float>(box[0] / (sx == 0 ? 1 : sx));
  bounds[1] = static_cast<float>(box[2] / (sy == 0 ? 1 : sy));
  bounds[2] = static_cast<float>((box[1] - box[0] + 1) / (sx == 0 ? 1 : sx));
  bounds[3] = static_cast<float>((box[3] - box[2] + 1) / (sy == 0 ? 1 : sy));
}

void SvgDevice::DrawImage(float corner[2], float scale, vtkImageData* image) {
  const int* size = image->GetDimensions();
  const auto width = scale * static_cast<float>(size[0]);
  const auto height = scale * static_cast<float>(size[1]);
  DrawImage(vtkRectf(corner[0], corner[1], width, height), image);
}

void SvgDevice::DrawImage(const vtkRectf& place, vtkImageData* image) {
  const float corners[4] = {place.GetLeft(), place.GetBottom(), place.GetRight(), place.GetTop()};
  const std::vector<double> page = toPage(corners, 2);
  if (page.empty()) return;
  // Cells have edges, which a browser would blur.
  element("image",
          fmt::format("x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
                      "style=\"image-rendering:pixelated\" href=\"{}\"",
                      pixel(page[0]), pixel(page[3]), pixel(page[2] - page[0]),
                      pixel(page[1] - page[3]), pngUri(image)));
}

void SvgDevice::SetMatrix(vtkMatrix3x3* matrix) {
  std::copy(matrix->GetData(), matrix->GetData() + 9, matrix_.begin());
}

void SvgDevice::GetMatrix(vtkMatrix3x3* matrix) {
  std::copy(matrix_.begin(), matrix_.end(), matrix->GetData());
}

void SvgDevice::MultiplyMatrix(vtkMatrix3x3* matrix) {
  Matrix product;
  vtkMatrix3x3::Multiply3x3(matrix_.data(), matrix->GetData(), product.data());
  matrix_ = product;
}

void SvgDevice::PopMatrix() {
  if (stack_.empty()) return;
  matrix_ = stack_.back();
  stack_.pop_back();
}

void SvgDevice::EnableClipping(bool enable) {
  // Clips do not nest: a new one ends the one before.
  if (clip_open_) body_ += "</g>";
  clip_open_ = enable;
  in_data_ = false;
  if (!enable) return;
  const std::string name = fmt::format("{}-clip{}", id_, clip_count_++);
  // VTK's rectangle stands on its lower left corner, SVG's hangs from the upper one.
  defs_ += fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>", name,
      clip_[0], pixel(height_ - clip_[1] - clip_[3]), clip_[2], clip_[3]);
  body_ += "<g clip-path=\"url(#" + name + ")\">";
}

bool DrawnPlot::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

/// Those of the axes, which are fixed, so that no drawing moves them.
void DrawnPlot::GetBounds(double bounds[4]) {
  bounds[0] = bounds[2] = 0;
  bounds[1] = bounds[3] = 1;
}

bool DrawnItem::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

}  // namespace plumbline::internal
