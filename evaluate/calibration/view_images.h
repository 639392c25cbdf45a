// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluate/session/load_session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// Keeps the images of the views with the largest errors (kWorstViews, of the camera stage, or of
/// the camera-IMU stage where the cameras were given) in the record: grey, made smaller by a whole
/// factor to at most 800 pixels of width, of JPEG quality 60. Views of a camera that comes as
/// corners have none, nor those whose image cannot be read any more: the result stands without.
void addViewImages(const LoadedSession& loaded, CalibrationRecord& record);

}  // namespace plumbline
