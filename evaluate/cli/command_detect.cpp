// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/progress_bar.h"
#include "evaluate/cli/session_options.h"
#include "evaluate/workflow/load_session.h"
#include "evaluate/workflow/write_session.h"

namespace plumbline {
namespace {

struct Options {
  SessionOptions session;
  std::string out;
};

int detect(const Options& o) {
  ProgressBar bar;
  refuseInside(o.out, o.session.session, "--out");
  const LoadedSession loaded = loadSession(o.session.request(), bar.sink());
  bar.clear();
  writeCornerSession(loaded.session, o.out);
  for (std::size_t i = 0; i < loaded.counts.size(); ++i) {
    const CameraCounts& counts = loaded.counts[i];
    fmt::print("{}: {} corners of {} tags in {} of {} images\n", loaded.session.cameras[i].name,
               counts.corners, counts.tags, counts.views_with_corners, counts.views_offered);
  }
  fmt::print("Session of corners: {}\n", o.out);
  return kDone;
}

}  // namespace

Command detectCommand() {
  return {"detect", "Find the corners of every image and write a session of corners",
          "plumbline detect session --out corners", [](CLI::App& app) {
            auto options = std::make_shared<Options>();
            options->session.declare(app);
            app.add_option("--out", options->out, "Folder to write; must not exist, or be empty")
                ->required();
            return std::function<int()>([options] { return detect(*options); });
          }};
}

}  // namespace plumbline
