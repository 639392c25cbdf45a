// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>

#include "datasets/files/file_io.h"
#include "evaluate/study/plan.h"

namespace plumbline {

/// A step in the making: every word goes into the command, and what it stands for into the key.
class StepBuilder {
 public:
  StepBuilder(StepKind kind, std::string name, InputHashes& hashes) : hashes_(hashes) {
    step_.kind = kind;
    step_.name = std::move(name);
    key_ = toString(kind) + "\n";
  }

  StepBuilder& words(std::initializer_list<std::string> list) {
    for (const std::string& word : list) {
      step_.words.push_back(word);
      key_ += word + "\n";
    }
    return *this;
  }
  /// A word whose places are of this machine; the key has it as the study's definition does.
  StepBuilder& filled(const std::string& word, const std::string& as_written) {
    step_.words.push_back(word);
    key_ += as_written + "\n";
    return *this;
  }
  /// A word that no result depends on: where to write, how many threads.
  StepBuilder& aside(const std::string& word) {
    step_.words.push_back(word);
    return *this;
  }
  StepBuilder& reads(const std::filesystem::path& path) {
    step_.words.push_back(path.string());
    return watches(path);
  }
  /// An input whose path stands within another word.
  StepBuilder& watches(const std::filesystem::path& path) {
    const InputHashes::Hashed hashed = hashes_.of(path);
    step_.inputs.push_back({path.string(), hashed.stamp});
    key_ += "contents " + hashed.content + "\n";
    return *this;
  }
  /// A file that an earlier step made, or its folder for "".
  StepBuilder& reads(const Step& earlier, const std::string& file) {
    step_.words.push_back("{result:" + earlier.name + "}" + (file.empty() ? "" : "/" + file));
    return needs(earlier);
  }
  StepBuilder& shapeOf(const Step& earlier) {
    step_.words.push_back("{shape:" + earlier.name + "}");
    return needs(earlier);
  }
  StepBuilder& needs(const Step& earlier) {
    if (std::ranges::find(step_.needs, earlier.name, &StepNeed::name) == step_.needs.end()) {
      step_.needs.push_back({earlier.name, earlier.key});
    }
    key_ += "result " + earlier.inputs_key + "\n";
    return *this;
  }

  Step build(const std::string& session, const std::string& part, const StudyDefinition& study,
             const ProgramId& program) {
    step_.session = session;
    step_.part = part;
    step_.program = program.hash;
    step_.limit_s = study.step_limit_s;
    step_.limit_mb = study.step_limit_mb;
    step_.keep_records = study.keep_records;
    step_.inputs_key = contentHash(key_);
    // Figures do not depend on what is kept, so the history goes on; the result does.
    step_.key = contentHash(step_.inputs_key + "\n" + program.version + " " + program.hash +
                            (study.keep_records ? " records" : ""));
    return step_;
  }

 private:
  Step step_;
  std::string key_;
  InputHashes& hashes_;
};

}  // namespace plumbline
