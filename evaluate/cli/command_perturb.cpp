// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/session/study_reader.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/studies/perturbation_study.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

/// One kind of perturbation as an option: a list of amounts.
struct KindOption {
  const char* name;
  PerturbationKind kind;
  const char* help;
};

constexpr KindOption kKinds[] = {
    {"--offsets-ms", PerturbationKind::kImuShift,
     "Add each of these to every IMU stamp [ms]: 100,10,1 or -500:50:500"},
    {"--target-size-percent", PerturbationKind::kTargetSize,
     "Increase the stated target size by each of these [%]"},
    {"--noise-factors", PerturbationKind::kNoiseDensities,
     "Multiply the IMU's four noise densities by each of these"},
    {"--initial-focal-percent", PerturbationKind::kInitialIntrinsics,
     "Increase the initial focal lengths by each of these [%]"},
    {"--drop-frames-percent", PerturbationKind::kDroppedFrames,
     "Drop this share of the frames [%]"},
    {"--drop-imu-percent", PerturbationKind::kDroppedImu, "Drop this share of the IMU samples [%]"},
    {"--corner-noise-px", PerturbationKind::kCornerNoise,
     "Add Gaussian noise of this standard deviation to every corner [px]"},
};

struct PerturbOptions {
  std::string study;
  SessionOptions session;
  EstimationOptions estimation;
  ResultOptions output;
  // As words: they are read once those of the study's file have joined them.
  std::vector<std::string> amounts = std::vector<std::string>(std::size(kKinds));
  std::vector<std::string> names;  ///< of the lists: options, or keys of the study's file
  int repeats = 1;
  std::uint64_t seed = 1;
};

void declarePerturb(CLI::App& app, PerturbOptions& o) {
  o.session.declare(app);
  app.add_option(
      "--study", o.study,
      "YAML file with any of the lists below by name, e.g. offsets-ms: [100, 10, 1]; a list "
      "that is given as an option takes its place");
  for (std::size_t i = 0; i < std::size(kKinds); ++i) {
    app.add_option(kKinds[i].name, o.amounts[i], kKinds[i].help);
  }
  addWithDefault(app, "--repeats", o.repeats,
                 "Draws of each random perturbation, with consecutive seeds")
      ->check(numberFrom(1));
  addWithDefault(app, "--seed", o.seed, "First seed of the random perturbations")
      ->check(seedFrom(1));
  o.estimation.declare(app);
  o.output.declareResult(app);
}

// Lists of the study's file stand where the command line gives none.
void readStudy(PerturbOptions& o) {
  for (const KindOption& kind : kKinds) o.names.emplace_back(kind.name);
  if (o.study.empty()) return;
  std::vector<std::string> known;
  for (const KindOption& kind : kKinds) known.emplace_back(kind.name + 2);  // without "--"
  for (const auto& [name, value] : readStudyDefinition(o.study, known)) {
    const auto at =
        static_cast<std::size_t>(std::find(known.begin(), known.end(), name) - known.begin());
    if (!o.amounts[at].empty()) continue;
    o.amounts[at] = value;
    o.names[at] = fmt::format("{}: {}", o.study, name);
  }
}

/// Ahead of the work.
void checkAmount(const Perturbation& p, bool no_imu) {
  if (no_imu && needsImu(p.kind)) {
    throw InputError(p.name() + " changes what --no-imu leaves out; omit one of the two");
  }
  p.check();
  if (p.kind == PerturbationKind::kImuShift) {
    (void)nanosecondsFromMilliseconds(p.name(), p.amount);
  }
}

std::vector<Perturbation> perturbationsOf(const PerturbOptions& o) {
  std::vector<Perturbation> list;
  for (std::size_t i = 0; i < std::size(kKinds); ++i) {
    if (o.amounts[i].empty()) continue;
    // What is not random comes out the same every time.
    const int draws = isRandom(kKinds[i].kind) ? o.repeats : 1;
    for (const double amount : amountsFrom(o.names[i], o.amounts[i])) {
      const Perturbation first{kKinds[i].kind, amount, o.seed, o.names[i]};
      checkAmount(first, o.estimation.no_imu);
      for (int draw = 0; draw < draws; ++draw) {
        // Consecutive seeds: one draw of all amounts is nested or scaled (perturbation.cpp), the
        // next one is fresh.
        list.push_back(first);
        list.back().seed += static_cast<std::uint64_t>(draw);
      }
    }
  }
  if (list.empty()) {
    throw InputError(
        "nothing to perturb: expected --offsets-ms 100,10,1, another list, or --study FILE");
  }
  return list;
}

/// On a copy of the options, which the study's lists join.
PerturbRequest perturbRequest(PerturbOptions o, const CLI::App& app) {
  for (std::size_t i = 0; i < std::size(kKinds); ++i) {
    // One without an entry would pass for one that was not given.
    if (app.count(kKinds[i].name) > 0) (void)entriesOf(kKinds[i].name, o.amounts[i]);
  }
  readStudy(o);
  PerturbRequest request;
  o.estimation.estimate(o.session, request);
  // Its lists decide the result, so its content belongs to the input hash.
  if (!o.study.empty()) request.load.others.push_back(o.study);
  request.perturbations = perturbationsOf(o);
  request.threads = request.load.threads;
  request.provenance = makeProvenance("perturb", givenOptions(app));
  return request;
}

int perturb(const PerturbOptions& o, const CLI::App& app) {
  ProgressBar bar;
  const PerturbRequest request = perturbRequest(o, app);
  ResultWriter out(o.output, o.output.request("perturbation study", o.session,
                                              givenInputs({o.estimation.cameras, o.study})));
  auto record = perturbSession(request, bar.sink());
  bar.clear();
  if (!record) return tellFailure(record.failure(), app);
  for (PerturbationCase& c : record.value().cases) c.problem = withOwners(c.problem, app);
  nameOwners(record.value().verdict, app);
  return out.finish(*record,
                    {{"perturbation.json", documentOf(*record)},
                     {"perturbation.csv", perturbationTable(*record)}},
                    renderPerturbationPage, perturbationSummary(*record));
}

}  // namespace

Command perturbCommand() {
  return {"perturb", "Recalibrate under known perturbations: what is recovered, what else changes",
          "plumbline perturb session --offsets-ms 100,10,1 --out study",
          withOptions(declarePerturb, perturb)};
}

}  // namespace plumbline
