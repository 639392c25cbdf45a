// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "report/html/scene.h"
#include "report/html/section.h"
#include "report/html/text.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// The normal density about zero, times `area`, dashed over [-range, range].
Series normalCurve(const std::string& name, double deviation, double range, double area);

/// Parameters with estimate and deviations: a table per camera, per extrinsic transform, and for
/// the IMU.
std::vector<Block> parameterBlocks(const CalibrationRecord& record);

/// The RMSE of every frame over time, then for each camera: scatter and histogram of the errors,
/// their mean as a vector field over the image and their RMSE by region.
std::vector<Block> reprojectionFigures(const StageView& stage);

/// For each camera a map of how many corners fell where.
Section coverageSection(const StageView& stage);

/// The correlation matrix of each stage's parameters; none without a covariance.
Section correlationSection(const CalibrationRecord& record);

// Of plots over time: `origin` is the stamp where the page's time starts.

/// What the sensors read on average between frames beside what the states predict, with bands of
/// three standard deviations; of long recordings the interval of each run that differs most.
Section readingsSection(const CameraImuStageResult& stage, TimeNs origin);

/// Gyroscope and accelerometer residuals over time, raw with the band that the samples' noise
/// explains, and normalised, with histograms beside the normal distribution that the assumptions
/// let expect; what they say of the densities, and what the verdict made of it.
Section inertialSection(const CameraImuStageResult& stage, TimeNs origin, const Verdict& verdict);

/// Both biases over time, each axis about its mean.
Section biasSection(const CameraImuStageResult& stage, TimeNs origin);

/// What a check says of the noise density that was assumed, with what the verdict made of it; null
/// where the verdict has no finding on it.
std::string densityRemark(const std::string& sensor, const ImuNoiseCheck& check,
                          const Finding* judged);

/// The lens models that were tried for each camera, and why one was chosen. For a record with
/// CameraStageResult::models.
Section modelSection(const CameraStageResult& stage);

/// How the halves of the recording differ, block by block of parameters; empty where no stage has
/// compared them.
Section halvesSection(const CalibrationRecord& record);

/// The board's own shape as the camera stage found it: what was found, its terms with their
/// deviations, heights tag by tag, displacements corner by corner. For a record with a target_fit.
Section targetSection(const AprilGrid& grid, const CameraStageResult& stage);

/// Single views of a stage: a picture of one view's corners with their errors as arrows, the
/// numbers and pose of it, and a table of the worst. A moment that is picked in any plot over time,
/// a row of the table, keys or the slider choose the view. `T_FC0`: pose of camera 0 in every
/// frame. `images`: those that the record has, shown below the corners of their views.
Section viewsSection(const StageView& stage, const std::vector<Transform>& T_FC0,
                     const std::vector<ViewImage>& images);

/// How evenly the samples of every sensor follow each other: figures, a plot over time, and the
/// longest gaps by name.
Section intervalsSection(const CalibrationRecord& record);

/// A held calibration's scores: on the recording, K-fold validation, held-out recordings, each with
/// one column per camera, and bars of the RMSE per camera.
Section heldScoresSection(const HeldCalibration& held);

}  // namespace plumbline::html_internal
