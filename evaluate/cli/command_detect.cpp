// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/session/load_session.h"
#include "generated/version.h"

namespace plumbline {
namespace {

struct DetectOptions {
  SessionOptions session;
  OutputOptions output;
  JsonOption json;
};

void declareDetect(CLI::App& app, DetectOptions& o) {
  o.session.declare(app);
  // Corners do not depend on the board's shape, and a session of them states none.
  app.remove_option(app.get_option("--target-shape"));
  o.output.declare(app, "Folder to write")->required();
  o.json.declare(app);
}

// What a machine wants to know of the detection: counts of every camera and the input's hash.
std::string detectionDocument(const LoadedSession& loaded) {
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < loaded.counts.size(); ++i) {
    const CameraCounts& counts = loaded.counts[i];
    cameras.push_back({{"name", loaded.session.cameras[i].name},
                       {"views_offered", counts.views_offered},
                       {"views_with_corners", counts.views_with_corners},
                       {"corners", counts.corners},
                       {"tags", counts.tags}});
  }
  return nlohmann::ordered_json{{"schema", 1},
                                {"plumbline", kVersion},
                                {"input_hash", loaded.input_hash},
                                {"seconds", {{"load", loaded.load_s}, {"detect", loaded.detect_s}}},
                                {"cameras", cameras}}
             .dump(2) +
         "\n";
}

int detect(const DetectOptions& o, const CLI::App& app) {
  ProgressBar bar;
  LoadRequest request = o.session.request();
  request.read.supported_models_only = false;  // corners need no model
  const OutputRequest output = o.output.request("session of corners", o.session);
  OutputFolder out(output);
  std::optional<OutputFile> json =
      o.json.reserve(o.output, output.inputs, o.output.out, kDocumentMark);
  const LoadedSession loaded = loadSession(request, bar.sink());
  bar.clear();
  // Corners that are given stay as they are, and are not ours: what our detector does alike in all
  // images is in the deviations of what it found alone.
  if (loaded.common_error_share == 0) {
    throw InputError(fmt::format(
        "{}: the corners of its cameras are given, there is nothing to detect", request.session));
  }
  // The layout first: images that contradict the stated spacing may have no corner left, and this
  // names the line that is wrong. Distortion is not known here, hence the wider tolerance.
  checkTargetLayout(loaded, {});
  // A session without a corner would be refused by every command that reads it.
  if (const auto nothing = noTagSeen(loaded)) {
    return tellFailure(locate(*nothing, loaded, request.session), app);
  }
  writeCornerSession(loaded.session, out.path());
  const std::string document = detectionDocument(loaded);
  out.write(kDetectionFile, document);
  out.commit();
  if (json) json->write(document);
  if (o.json.piped()) {
    writeDocument(document);
    return kDone;
  }
  for (std::size_t i = 0; i < loaded.counts.size(); ++i) {
    const CameraCounts& counts = loaded.counts[i];
    say("{}: {} corners of {} tags in {} of {} images\n", loaded.session.cameras[i].name,
        counts.corners, counts.tags, counts.views_with_corners, counts.views_offered);
  }
  say("Session of corners: {}\n", o.output.out);
  return kDone;
}

}  // namespace

Command detectCommand() {
  return {"detect", "Detect the corners in every image and write a session of corners",
          "plumbline detect session --out corners", withOptions(declareDetect, detect)};
}

}  // namespace plumbline
