// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "evaluate/process/process.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/text.h"
#include "evaluate/study/engine/local_engine.h"
#include "evaluate/study/engine/slurm_engine.h"

namespace plumbline {

namespace fs = std::filesystem;

std::vector<std::vector<Step>> unsettledStages(const fs::path& night,
                                               const std::vector<Step>& steps) {
  const StepResults settled = settledResults(night, steps);
  std::map<std::string, std::size_t> stage_of;  // of those to do
  std::vector<std::vector<Step>> stages;
  for (const Step& step : steps) {
    if (settled.count(step.name) > 0) continue;
    // The longest chain of unsettled needs before it; those that are settled hold nothing up.
    std::size_t stage = 0;
    for (const StepNeed& need : step.needs) {
      const auto before = stage_of.find(need.name);
      if (before != stage_of.end()) stage = std::max(stage, before->second + 1);
    }
    stage_of[step.name] = stage;
    if (stages.size() <= stage) stages.resize(stage + 1);
    stages[stage].push_back(step);
  }
  return stages;
}

std::string commandList(const fs::path& night, const std::vector<Step>& steps,
                        const std::string& study, const std::string& out) {
  const std::string program = shellWords({thisProgram()});
  Text text;
  int number = 0;
  for (const std::vector<Step>& stage : unsettledStages(night, steps)) {
    add(text, "# stage {}: {} commands\n", ++number, stage.size());
    for (const Step& step : stage) {
      // Names of steps need no quotes: they are made of names that nameOf() lets pass.
      add(text, "{} study run-step {} {}\n", program, shellWords({night.string()}), step.name);
    }
  }
  add(text, "# then\n{} study {} --out {}\n", program,
      shellWords({fs::absolute(study).lexically_normal().string()}),
      shellWords({fs::absolute(out).lexically_normal().string()}));
  return fmt::to_string(text);
}

}  // namespace plumbline
