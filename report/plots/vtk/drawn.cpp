// SPDX-License-Identifier: BSD-3-Clause
#include <vtkObjectFactory.h>

#include "report/plots/vtk/svg_device.h"

namespace plumbline::internal {
namespace {

bool paint(const Drawing& drawing, vtkContext2D* painter) {
  auto* device = dynamic_cast<SvgDevice*>(painter->GetDevice());
  if (!drawing || !device) return false;
  drawing(*painter, *device);
  device->setShapeTitle("");
  device->setShapeLink("");
  return true;
}

}  // namespace

vtkStandardNewMacro(DrawnPlot);
vtkStandardNewMacro(DrawnItem);

bool DrawnPlot::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

void DrawnPlot::GetBounds(double bounds[4]) {
  bounds[0] = bounds[2] = 0;
  bounds[1] = bounds[3] = 1;
}

bool DrawnItem::Paint(vtkContext2D* painter) { return paint(drawing, painter); }

}  // namespace plumbline::internal
