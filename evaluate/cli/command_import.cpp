// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/error.h"
#include "datasets/bag/import_bag.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "generated/version.h"

namespace plumbline {
namespace {

struct ImportOptions {
  BagImport request;
  bool no_imu = false;
  bool list = false;
  OutputOptions output;
  JsonOption json;
};

void declareImport(CLI::App& app, ImportOptions& o) {
  BagImport& r = o.request;
  app.add_option(
         "recording", r.bags,
         "Bag of ROS 1 (.bag) or of ROS 2 (.mcap, .db3 or its folder); several of one recording")
      ->required();
  auto* out = o.output.declare(app, "Folder for the session (required, except with --list)");
  app.add_flag("--list", o.list, "Only print the topics of the recording")->excludes(out);
  addList(app, "--camera-topics", r.camera_topics,
          "Topics of cam0, cam1, ... (default: all with images, by name, without depth)");
  auto* imu_topic = app.add_option("--imu-topic", r.imu_topic,
                                   "Topic of the IMU (default: that of imu.yaml, or the only one)");
  app.add_flag("--no-imu", o.no_imu, "Cameras only")->excludes(imu_topic);
  app.add_option("--target", r.target_path, "Kalibr's target.yaml, to lie in the session");
  app.add_option("--imu", r.imu_path, "Kalibr's imu.yaml, to lie in the session");
  addWithDefault(app, "--threads", r.threads, "Threads (0: all cores); results do not depend on it")
      ->check(numberFrom(0));
  o.json.declare(app);
}

nlohmann::ordered_json jsonOf(const ImportedSensor& s) {
  nlohmann::ordered_json json{{"name", s.name},        {"topic", s.topic},
                              {"count", s.count},      {"repeated", s.repeated},
                              {"first_t_ns", s.first}, {"last_t_ns", s.last},
                              {"rate_hz", s.rate_hz}};
  if (s.resolution.width > 0) json["resolution"] = {s.resolution.width, s.resolution.height};
  return json;
}

std::string importDocument(const std::vector<ImportedSensor>& sensors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ImportedSensor& sensor : sensors) list.push_back(jsonOf(sensor));
  return nlohmann::ordered_json{{"schema", 1}, {"plumbline", kVersion}, {"sensors", list}}.dump(2) +
         "\n";
}

int listTopics(const ImportOptions& o) {
  if (o.json.file && !o.json.piped()) {
    throw InputError("--list writes no file; give --json - for its topics as JSON");
  }
  const std::vector<BagTopic> topics = topicsOf(o.request.bags);
  if (o.json.piped()) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const BagTopic& topic : topics) {
      list.push_back({{"name", topic.name}, {"type", topic.type}, {"messages", topic.messages}});
    }
    writeDocument(list.dump(2) + "\n");
    return kDone;
  }
  for (const BagTopic& topic : topics) {
    say("{:>9}  {:<28}  {}\n", topic.messages, topic.type, topic.name);
  }
  return kDone;
}

void tellSensors(const ImportOptions& o, const std::vector<ImportedSensor>& sensors) {
  for (const ImportedSensor& s : sensors) {
    const bool is_camera = s.resolution.width > 0;
    say("{}: {} {} at {:.4g} Hz over {:.1f} s from {}\n", s.name, s.count,
        is_camera ? fmt::format("images of {} x {}", s.resolution.width, s.resolution.height)
                  : "samples",
        s.rate_hz, 1e-9 * static_cast<double>(s.last - s.first), s.topic);
    if (s.repeated > 0) {
      say("{}: {} messages were there twice and were left out once\n", s.name, s.repeated);
    }
  }
  const bool has_imu = sensors.back().resolution.width == 0;
  if (!o.request.target_path) say("No target.yaml yet: give it to other commands by --target\n");
  if (has_imu && !o.request.imu_path) say("No imu.yaml yet: give it to other commands by --imu\n");
  say("Session: {}\n", o.output.out);
}

int importRecording(const ImportOptions& o) {
  if (o.list) return listTopics(o);
  if (o.output.out.empty()) {
    throw InputError("--out is required; name the folder to write, or ask for --list");
  }
  BagImport request = o.request;
  request.import_imu = !o.no_imu;
  std::vector<std::string> inputs = givenInputs({request.target_path, request.imu_path});
  inputs.insert(inputs.end(), request.bags.begin(), request.bags.end());
  OutputFolder out(o.output.request("session", inputs));
  std::optional<OutputFile> json =
      o.json.reserve(o.output, std::move(inputs), o.output.out, kDocumentMark);
  ProgressBar bar;
  request.progress = [&](std::size_t done, std::size_t all) {
    bar.update("reading messages", static_cast<double>(done) / static_cast<double>(all));
  };
  const std::vector<ImportedSensor> sensors = importBags(request, out.path());
  bar.clear();
  const std::string document = importDocument(sensors);
  out.write("import.json", document);
  out.commit();
  if (json) json->write(document);
  if (o.json.piped()) {
    writeDocument(document);
  } else {
    tellSensors(o, sensors);
  }
  return kDone;
}

}  // namespace

Command importCommand() {
  return {"import", "Make a session of a recording of ROS 1 or ROS 2, without ROS",
          "plumbline import recording.bag --target target.yaml --imu imu.yaml --out session",
          withOptions(declareImport, importRecording)};
}

}  // namespace plumbline
