// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include <vtkContext2D.h>
#include <vtkContextDevice2D.h>
#include <vtkContextItem.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkUnicodeString.h>

namespace plumbline::internal {

/// Escapes &, <, > and quotes for XML text and attributes.
std::string escapeXml(const std::string& text);

/// A coordinate to a tenth of a pixel, without trailing zeros ("12", "12.5", "-0.1").
std::string pixel(double value);

/// The same to a hundredth: of data that are zoomed.
std::string finePixel(double value);

/// "x,y x,y ..." of page points x y x y, each as `write` has it.
std::string pointList(const std::vector<double>& points, std::string (*write)(double) = pixel);

/// A line's points (page pixels, x y x y) thinned to what can be seen. Where x never falls: of each
/// half pixel the first, the lowest, the highest and the last. Otherwise: equal neighbours (to
/// 0.05 pixels) are merged. Short lines stay as they are.
std::vector<double> thinLine(const std::vector<double>& points);

/// A device for VTK's 2D painter that writes SVG text. It stands in for vtkSVGContextDevice2D,
/// whose faults (VTK 9.1) spoil charts: clips in data units and unflipped, six digits, anisotropic
/// strokes, invalid text attributes, colliding ids. Here
///   - every coordinate goes through the painter's matrix to page pixels before it is written (y
///     down, a tenth of a pixel, data a hundredth), so that clips and stroke widths are plain
///     pixels;
///   - fonts are pixels, measured at 72 DPI, anchored with valid attributes;
///   - long lines keep first, lowest, highest and last point of every half pixel;
///   - a cloud of markers is one path of zero-length strokes with round caps;
///   - ids begin with the plot's own.
class SvgDevice : public vtkContextDevice2D {
 public:
  static SvgDevice* New();
  /// Empties the drawing; `height` is that of the page [px], `id` prefixes ids.
  void start(const std::string& id, double height);
  /// <defs> and shapes, without the enclosing <svg>.
  std::string content() const;
  /// A <title> for the shapes drawn until the next call; empty for none.
  void setShapeTitle(const std::string& title) { shape_title_ = title; }
  /// Where these shapes lead; empty for nowhere.
  void setShapeLink(const std::string& link) { shape_link_ = link; }
  /// Class of the words drawn until the next call ("tx", "ty": labels of an axis' ticks); empty for
  /// none.
  void setTextClass(const std::string& name) { text_class_ = name; }
  /// Lines and areas drawn from now until the clip ends are data (class "data"), not grid lines.
  void startData() { in_data_ = true; }

  void DrawPoly(float* points, int n, unsigned char* colours, int components) override;
  void DrawLines(float* points, int n, unsigned char* colours, int components) override;
  // A series has one colour, the pen's: those of single points are not looked at.
  void DrawPoints(float* points, int n, unsigned char* colours, int components) override {
    DrawMarkers(0, false, points, n, colours, components);
  }
  void DrawPointSprites(vtkImageData*, float* points, int n, unsigned char* colours,
                        int components) override {
    DrawMarkers(0, false, points, n, colours, components);
  }
  void DrawMarkers(int shape, bool highlight, float* points, int n, unsigned char* colours,
                   int components) override;
  void DrawQuad(float* points, int n) override { DrawPolygon(points, n); }
  void DrawQuadStrip(float* points, int n) override;
  void DrawPolygon(float* points, int n) override;
  void DrawColoredPolygon(float* points, int n, unsigned char*, int) override {
    DrawPolygon(points, n);
  }
  void DrawEllipseWedge(float x, float y, float outer_x, float outer_y, float, float,
                        float start_angle, float stop_angle) override {
    DrawEllipticArc(x, y, outer_x, outer_y, start_angle, stop_angle);
  }
  void DrawEllipticArc(float x, float y, float radius_x, float radius_y, float start_angle,
                       float stop_angle) override;
  void DrawString(float* point, const vtkStdString& text) override;
  void DrawString(float* point, const vtkUnicodeString& text) override {
    DrawString(point, vtkStdString(text.utf8_str()));
  }
  void DrawMathTextString(float* point, const vtkStdString& text) override {
    DrawString(point, text);
  }
  void ComputeStringBounds(const vtkStdString& text, float bounds[4]) override;
  void ComputeStringBounds(const vtkUnicodeString& text, float bounds[4]) override {
    ComputeStringBounds(vtkStdString(text.utf8_str()), bounds);
  }
  void ComputeJustifiedStringBounds(const char* text, float bounds[4]) override {
    ComputeStringBounds(vtkStdString(text), bounds);
  }
  void DrawImage(float corner[2], float scale, vtkImageData* image) override;
  void DrawImage(const vtkRectf& place, vtkImageData* image) override;
  void SetColor4(unsigned char*) override {}  // colours are read from pen and brush
  void SetTexture(vtkImageData*, int) override {}
  void SetPointSize(float size) override { Pen->SetWidth(size); }
  void SetLineWidth(float width) override { Pen->SetWidth(width); }
  void SetLineType(int type) override { Pen->SetLineType(type); }
  void SetMatrix(vtkMatrix3x3* matrix) override;
  void GetMatrix(vtkMatrix3x3* matrix) override;
  void MultiplyMatrix(vtkMatrix3x3* matrix) override;
  void PushMatrix() override { stack_.push_back(matrix_); }
  void PopMatrix() override;
  void SetClipping(int* rectangle) override { std::copy(rectangle, rectangle + 4, clip_.begin()); }
  void EnableClipping(bool enable) override;

 protected:
  SvgDevice() = default;

 private:
  using Matrix = std::array<double, 9>;
  /// Points in page pixels, x y x y.
  std::vector<double> toPage(const float* points, int n) const;
  void element(const std::string& shape, const std::string& attributes);
  /// How the coordinates of what is drawn now are written: finer for data, unless they are many.
  std::string (*writer(const std::vector<double>& page) const)(double);
  std::string strokeAttributes() const;
  std::string fillAttributes() const;

  std::string id_ = "plot";
  double height_ = 0;
  std::string defs_, body_, shape_title_, shape_link_, text_class_;
  Matrix matrix_{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::vector<Matrix> stack_;
  std::array<int, 4> clip_{};
  int clip_count_ = 0;
  bool clip_open_ = false;
  bool in_data_ = false;
};

/// Paints with VTK's 2D painter; coordinates are those of the item that calls it.
using Drawing = std::function<void(vtkContext2D& painter, SvgDevice& device)>;

/// What VTK has no plot for (bars with titles, boxes, arrows, cell labels), inside the axes and
/// clipped by them. Coordinates run from 0 to 1 along both axes.
class DrawnPlot : public vtkPlot {
 public:
  Drawing drawing;  ///< nothing is painted while it is empty
  static DrawnPlot* New();
  bool Paint(vtkContext2D* painter) override;
  void GetBounds(double bounds[4]) override;

 protected:
  DrawnPlot() = default;
};

/// What stands beside the axes (title, legend, colour bar). Coordinates are pixels, y up.
class DrawnItem : public vtkContextItem {
 public:
  Drawing drawing;  ///< nothing is painted while it is empty
  static DrawnItem* New();
  bool Paint(vtkContext2D* painter) override;

 protected:
  DrawnItem() = default;
};

}  // namespace plumbline::internal
