// SPDX-License-Identifier: BSD-3-Clause
#include <vtkObjectFactory.h>

#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {
namespace {

bool paint(const Drawing& drawing, vtkContext2D* painter) {
  // A scene may be painted to other devices, which know no titles: nothing is drawn there.
  auto* device = dynamic_cast<SvgDevice*>(painter->GetDevice());
  if (!drawing || !device) return false;
  drawing(*painter, *device);
  // What is drawn next is another's, and has no title of this one's.
  device->setShapeTitle("");
  device->setShapeLink("");
  return true;
}

}  // namespace

vtkStandardNewMacro(DrawnPlot);
vtkStandardNewMacro(DrawnItem);

bool DrawnPlot::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

/// Those of the axes, which are fixed, so that no drawing moves them.
void DrawnPlot::GetBounds(double bounds[4]) {
  bounds[0] = bounds[2] = 0;
  bounds[1] = bounds[3] = 1;
}

bool DrawnItem::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

}  // namespace plumbline::internal
