// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/session/locate_failure.h"

#include <fstream>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace plumbline {
namespace {

std::string placeOf(FaultyInput input, const CalibrateRequest& request,
                    const LoadedSession& loaded) {
  switch (input) {
    case FaultyInput::kTarget:
      if (const int line = lineOf("tagSize", loaded.target_path); line > 0) {
        return fmt::format("{}:{}", loaded.target_path, line);
      }
      return loaded.target_path;
    case FaultyInput::kImuSamples:
      if (!loaded.imu_samples_path.empty()) return loaded.imu_samples_path;
      break;
    case FaultyInput::kCameras:
      if (request.cameras_file) return *request.cameras_file;
      break;
    case FaultyInput::kSession:
      break;
  }
  return request.load.session;
}

}  // namespace

int lineOf(const std::string& key, const std::string& path) {
  std::ifstream file(path);
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    if (text.rfind(key, 0) == 0) return line;
  }
  return 0;
}

Failure locate(Failure failure, const CalibrateRequest& request, const LoadedSession& loaded) {
  failure.message = placeOf(failure.input, request, loaded) + ": " + failure.message;
  return failure;
}

}  // namespace plumbline
