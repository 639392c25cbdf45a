// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "datasets/files/bad_input.h"

namespace plumbline {

/// A YAML mapping that knows its file and lines, so that each fault can be located.
class YamlMap {
 public:
  /// Reads a file whose top is a mapping: UTF-8, at most 4 MB, one document. Throws InputError for
  /// a missing file, a syntax error (with its line), a key given twice, or another kind of content;
  /// `what` says what the file should hold.
  static YamlMap load(const std::string& path, const std::string& what);

  /// The same of a text; `path` is what errors call it.
  static YamlMap parse(std::string_view text, const std::string& path, const std::string& what);

  bool has(const std::string& key) const;
  bool hasMap(const std::string& key) const;  ///< whether the key is there and holds a mapping
  const std::string& path() const { return path_; }
  int line() const;                          ///< where this mapping starts, from 1
  int lineOf(const std::string& key) const;  ///< of the key's value; of the mapping if missing
  std::vector<std::string> keys() const;     ///< in the order of the file
  /// How many keys there are of "PREFIX0", "PREFIX1", ...; throws InputError where one is left out
  /// before another.
  int countOf(const std::string& prefix) const;

  /// The value of a key; each throws InputError where it is missing or of another kind. `expected`
  /// says what the key should hold.
  double number(const std::string& key, const std::string& expected) const;
  int integer(const std::string& key, const std::string& expected) const;
  std::string text(const std::string& key, const std::string& expected) const;
  std::vector<double> numbers(const std::string& key, const std::string& expected) const;
  /// The same where null stands for no number.
  std::vector<std::optional<double>> numbersOrNull(const std::string& key,
                                                   const std::string& expected) const;
  /// A list of rows of numbers.
  std::vector<std::vector<double>> rows(const std::string& key, const std::string& expected) const;
  /// The same as a matrix; empty where it has another number of rows, or a row of columns.
  std::optional<Eigen::MatrixXd> matrix(const std::string& key, const std::string& expected,
                                        Eigen::Index rows, Eigen::Index columns) const;
  YamlMap map(const std::string& key, const std::string& expected) const;
  /// A list of mappings.
  std::vector<YamlMap> maps(const std::string& key, const std::string& expected) const;

  double numberOr(const std::string& key, double otherwise) const;
  /// Whether the key is there and holds a word for yes; InputError where it holds none for yes or
  /// no.
  bool isTrue(const std::string& key) const;
  std::string textOr(const std::string& key, const std::string& otherwise) const;

  /// An InputError at a key's value.
  BadInput fault(const std::string& key, const Complaint& complaint) const {
    return badInput(path_, lineOf(key), complaint);
  }
  /// The raw node; undefined where the key is missing.
  YAML::Node node(const std::string& key) const;

 private:
  YamlMap(std::string path, const YAML::Node& node);
  YAML::Node require(const std::string& key, const std::string& expected) const;
  BadInput wrongKind(const YAML::Node& value, const std::string& key,
                     const std::string& expected) const;
  double finite(const YAML::Node& value, const std::string& key, const std::string& expected) const;
  template <class Read>
  auto items(const YAML::Node& list, const std::string& key, const std::string& expected,
             Read read) const;

  std::string path_;
  YAML::Node node_;
};

}  // namespace plumbline
