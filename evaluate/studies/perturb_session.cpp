// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/studies/perturb_session.h"

#include "datasets/calibration/calibration_reader.h"
#include "evaluate/results/assumptions.h"
#include "evaluate/results/parallel_for.h"
#include "evaluate/session/match_cameras.h"

namespace plumbline {
namespace {

StudyInputs inputsOf(const PerturbRequest& request, const Session& session) {
  StudyInputs inputs;
  inputs.session = &session;
  inputs.camera = request.camera;
  inputs.camera_imu = request.camera_imu;
  auto& models = inputs.camera.models;
  if (models.size() == 1) models.resize(session.cameras.size(), models.front());
  if (request.cameras_file) {
    const std::string& file = *request.cameras_file;
    inputs.cameras = matchCameras(readCalibration(file), file, session);
    refuseUnsupportedModels(inputs.cameras, file);
    inputs.cameras_fixed = true;
  }
  return inputs;
}

}  // namespace

Result<PerturbationRecord> perturbSession(const PerturbRequest& asked,
                                          const ProgressSink& progress) {
  PerturbRequest request = asked;
  if (request.cameras_file) request.load.others.push_back(*request.cameras_file);
  const LoadedSession loaded = loadSession(request.load, progress);
  const StudyInputs inputs = inputsOf(request, loaded.session);
  PerturbationStudyOptions options;
  options.threads = threadCount(request.threads);
  options.thresholds = request.thresholds;
  options.progress = [&](std::size_t done, std::size_t all) {
    progress("calibrating perturbed sessions",
             static_cast<double>(done) / static_cast<double>(all));
  };
  progress("calibrating the session as it is", -1);
  auto record = perturbationStudy(inputs, request.perturbations, options);
  if (!record) return record;
  attribute(record.value(), request.provenance, loaded);
  record.value().assumptions = assumptionsOf(request.camera, request.camera_imu, loaded.session);
  return record;
}

}  // namespace plumbline
