// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkPlot.h>

#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {

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
