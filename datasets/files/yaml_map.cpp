// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/yaml_map.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/eventhandler.h>

#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

// What is written by hand or by a calibration is far smaller; a parser takes seconds for more. How
// deep it may be nested is yaml-cpp's own limit; what it names once and repeats, it holds once.
constexpr std::size_t kMostBytes = 4 << 20;

void refuseText(const std::string& path, std::string_view text, const std::string& what) {
  const auto refuse = [&](const std::string& fault) {
    throw badInput(path, {InputFault::kSyntax, fault, what, "correct the file"});
  };
  if (text.size() > kMostBytes) {
    refuse(fmt::format("has {} bytes, more than {}", text.size(), kMostBytes));
  }
  if (!isUtf8(text)) refuse("is not UTF-8");
}

/// Counts a text's documents, finds where the second one that holds something begins, and the first
/// scalar whose escapes (half of a surrogate pair) make it no UTF-8.
class Documents : public YAML::EventHandler {
 public:
  int count() const { return count_; }
  const std::optional<YAML::Mark>& second() const { return second_; }
  const std::optional<YAML::Mark>& unreadable() const { return unreadable_; }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override { ++count_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { found(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    found(mark);
    if (!unreadable_ && !isUtf8(value)) unreadable_ = mark;
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {
    found(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    found(mark);
  }
  void OnMapEnd() override {}

 private:
  void found(const YAML::Mark& mark) {
    if (count_ > 1 && !second_) second_ = mark;
  }

  int count_ = 0;
  std::optional<YAML::Mark> second_;
  std::optional<YAML::Mark> unreadable_;
};

// An empty one is no more than a mark at the end. After some faults of syntax yaml-cpp (0.7) finds
// document after document where there is no text any more, and LoadAll never ends: so it is not
// asked for more than a few.
void refuseUnreadable(const std::string& path, const std::string& text) {
  constexpr int kMost = 16;
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Documents documents;
  while (parser.HandleNextDocument(documents)) {
    if (documents.unreadable()) {
      throw badInput(
          path, documents.unreadable()->line + 1,
          {InputFault::kSyntax, "an escape sequence in this text is not a Unicode character",
           "text in UTF-8", "write the character itself"});
    }
    if (!documents.second() && documents.count() <= kMost) continue;
    const int line = documents.second() ? documents.second()->line + 1 : 0;
    throw badInput(path, line,
                   {InputFault::kSyntax, "a second YAML document starts here", "one document",
                    "write each into a separate file"});
  }
}

/// JSON is one document, and without escapes of characters its text is UTF-8 where the file is; a
/// zero byte, at which the parser asked here ends, is none of its characters. So told, a record is
/// read in half the time: yaml-cpp needs 0.1 s for a megabyte.
bool isPlainJson(const std::string& text) {
  return text.find("\\u") == std::string::npos && text.find('\0') == std::string::npos &&
         nlohmann::json::accept(text);
}

}  // namespace

YamlMap::YamlMap(std::string path, const YAML::Node& node) : path_(std::move(path)), node_(node) {
  // yaml-cpp does not mind a key that is given twice.
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (entry.first.IsScalar() && !seen.insert(entry.first.Scalar()).second) {
      throw badInput(
          path_, entry.first.Mark().line + 1,
          {InputFault::kDuplicate, "the key '" + entry.first.Scalar() + "' is given twice",
           "each key once", "delete one of them"});
    }
  }
}

YamlMap YamlMap::load(const std::string& path, const std::string& what) {
  return parse(MappedFile(path).text(), path, what);
}

YamlMap YamlMap::parse(std::string_view text, const std::string& path, const std::string& what) {
  refuseText(path, text, what);
  YAML::Node top;
  try {
    const std::string copy(text);
    if (!isPlainJson(copy)) refuseUnreadable(path, copy);
    top = YAML::Load(copy);
  } catch (const YAML::Exception& error) {
    throw badInput(
        path, error.mark.line + 1,
        {InputFault::kSyntax, "YAML syntax error (" + error.msg + ")", what, "correct the file"});
  }
  if (!top.IsMap()) {
    throw badInput(
        path, {InputFault::kUnknownFile, text.empty() ? "is empty" : "is not a YAML mapping", what,
               "correct the file"});
  }
  return {path, top};
}

YAML::Node YamlMap::node(const std::string& key) const {
  // On a const node: otherwise the question adds the key.
  return static_cast<const YAML::Node&>(node_)[key];
}

bool YamlMap::has(const std::string& key) const {
  const YAML::Node found = node(key);
  // null stands for what is not known: as if the key were not there.
  return found.IsDefined() && !found.IsNull();
}

bool YamlMap::hasMap(const std::string& key) const { return has(key) && node(key).IsMap(); }

int YamlMap::line() const { return node_.Mark().line + 1; }

int YamlMap::lineOf(const std::string& key) const {
  return has(key) ? node(key).Mark().line + 1 : line();
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : node_) {
    if (entry.first.IsScalar()) names.push_back(entry.first.Scalar());
  }
  return names;
}

int YamlMap::countOf(const std::string& prefix) const {
  int count = 0;
  while (has(fmt::format("{}{}", prefix, count))) ++count;
  for (const std::string& key : keys()) {
    if (!key.starts_with(prefix)) continue;
    int number = 0;
    const char* const end = key.data() + key.size();
    const auto [stop, error] = std::from_chars(key.data() + prefix.size(), end, number);
    if (error != std::errc() || stop != end || number < count || !has(key)) continue;
    const std::string missing = fmt::format("{}{}", prefix, count);
    throw fault(key,
                {InputFault::kMissingKey, fmt::format("'{}' is given without '{}'", key, missing),
                 fmt::format("{0}0, {0}1, ... without a gap", prefix),
                 fmt::format("add '{}', or number the others anew", missing)});
  }
  return count;
}

YAML::Node YamlMap::require(const std::string& key, const std::string& expected) const {
  if (!has(key)) {
    throw badInput(
        path_, line(),
        {InputFault::kMissingKey, "the key '" + key + "' is missing", expected, "add it"});
  }
  return node(key);
}

BadInput YamlMap::wrongKind(const YAML::Node& value, const std::string& key,
                            const std::string& expected) const {
  return badInput(path_, value.Mark().line + 1,
                  {InputFault::kBadNumber, "the value of '" + key + "' is not usable", expected,
                   "correct the value"});
}

/// .nan and .inf are numbers of YAML and of no calibration.
double YamlMap::finite(const YAML::Node& value, const std::string& key,
                       const std::string& expected) const {
  double number = 0;
  if (value.IsScalar() && YAML::convert<double>::decode(value, number) && std::isfinite(number)) {
    return number;
  }
  throw wrongKind(value, key, expected);
}

template <class Read>
auto YamlMap::items(const YAML::Node& list, const std::string& key, const std::string& expected,
                    Read read) const {
  if (!list.IsSequence()) throw wrongKind(list, key, expected);
  std::vector<decltype(read(list))> all;
  for (const YAML::Node& item : list) all.push_back(read(item));
  return all;
}

double YamlMap::number(const std::string& key, const std::string& expected) const {
  return finite(require(key, expected), key, expected);
}

int YamlMap::integer(const std::string& key, const std::string& expected) const {
  const YAML::Node found = require(key, expected);
  int value = 0;
  if (found.IsScalar() && YAML::convert<int>::decode(found, value)) return value;
  throw wrongKind(found, key, expected);
}

std::string YamlMap::text(const std::string& key, const std::string& expected) const {
  const YAML::Node found = require(key, expected);
  if (!found.IsScalar()) throw wrongKind(found, key, expected);
  return found.Scalar();
}

std::vector<double> YamlMap::numbers(const std::string& key, const std::string& expected) const {
  return items(require(key, expected), key, expected,
               [&](const YAML::Node& item) { return finite(item, key, expected); });
}

std::vector<std::optional<double>> YamlMap::numbersOrNull(const std::string& key,
                                                          const std::string& expected) const {
  return items(require(key, expected), key, expected, [&](const YAML::Node& item) {
    return item.IsNull() ? std::nullopt : std::optional(finite(item, key, expected));
  });
}

std::vector<std::vector<double>> YamlMap::rows(const std::string& key,
                                               const std::string& expected) const {
  return items(require(key, expected), key, expected, [&](const YAML::Node& row) {
    return items(row, key, expected,
                 [&](const YAML::Node& item) { return finite(item, key, expected); });
  });
}

std::optional<Eigen::MatrixXd> YamlMap::matrix(const std::string& key, const std::string& expected,
                                               Eigen::Index rows, Eigen::Index columns) const {
  const std::vector<std::vector<double>> stated = this->rows(key, expected);
  if (std::ssize(stated) != rows) return std::nullopt;
  Eigen::MatrixXd M(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::vector<double>& row = stated[static_cast<std::size_t>(i)];
    if (std::ssize(row) != columns) return std::nullopt;
    M.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), columns);
  }
  return M;
}

YamlMap YamlMap::map(const std::string& key, const std::string& expected) const {
  const YAML::Node found = require(key, expected);
  if (!found.IsMap()) throw wrongKind(found, key, expected);
  return {path_, found};
}

std::vector<YamlMap> YamlMap::maps(const std::string& key, const std::string& expected) const {
  return items(require(key, expected), key, expected, [&](const YAML::Node& entry) {
    if (!entry.IsMap()) throw wrongKind(entry, key, expected);
    return YamlMap(path_, entry);
  });
}

double YamlMap::numberOr(const std::string& key, double otherwise) const {
  return has(key) ? number(key, "a finite number") : otherwise;
}

bool YamlMap::isTrue(const std::string& key) const {
  if (!has(key)) return false;
  bool value = false;
  if (YAML::convert<bool>::decode(node(key), value)) return value;
  throw wrongKind(node(key), key, "true or false");
}

std::string YamlMap::textOr(const std::string& key, const std::string& otherwise) const {
  return has(key) ? text(key, "a word") : otherwise;
}

}  // namespace plumbline
