// SPDX-License-Identifier: BSD-3-Clause
// docs/records.md is what the field lists say: made here, for no program needs it.
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <typeindex>
#include <vector>

#include <gtest/gtest.h>

#include "report/records/comparison_record.h"
#include "report/records/field_walker.h"
#include "report/records/perturbation_record.h"
#include "report/records/replay_record.h"
#include "report/records/study_record.h"
#include "report/records/trajectory_record.h"
#include "report/store/packed_fields.h"

namespace plumbline {
namespace {

constexpr const char* kIntroduction = R"(# Documents and records

What Plumbline's commands write for other programs. These tables are generated from the field lists that
stand beside the records (`calibrator/fields`, `report/records`); a test keeps them up to date
(`PLUMBLINE_UPDATE_DOCS=1` writes them). `records.sqlite` keeps the same documents, the samples below each
table as packed arrays, and rows to query: every number with a unit is a metric (`report/store/sql/schema.sql`).

Fields may be added; a name here never changes its meaning. Units are SI and radians, pixels where the name
ends in `_px`; frames, signs and tangents are those of [conventions.md](conventions.md). A field that does
not apply is left out. A number that is not known (or not finite) is `null`, everywhere. `x[]` is a list,
`x.*` an object with a name for each value. Unit 1: counts, ratios, and true or false.
)";

/// The type whose field list a field of type T shows, if any.
template <class T>
struct Shown {
  using Type = T;
  static constexpr bool kList = false;
};
template <class T>
struct Shown<std::optional<T>> : Shown<T> {};
template <class T>
struct Shown<std::vector<T>> {
  using Type = typename Shown<T>::Type;
  static constexpr bool kList = true;
};
template <class T>
struct Shown<Named<T>> : Shown<T> {};

/// What has a field list of its own to unfold; everything else is one row.
template <class T>
concept Struct =
    std::is_class_v<T> && !std::is_same_v<T, std::string> && !std::is_same_v<T, Transform> &&
    !json_fields::Matrix<T> && !json_fields::List<T> && !ListedStruct<T>;

/// A bar would end the cell. Steps of two pass the bar that has just been escaped.
std::string escaped(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2)
    text.insert(i, "\\");
  return text;
}

/// A Markdown table of every field, and one of the arrays.
class TableSink {
 public:
  static constexpr bool kAll = true;

  template <class T>
  bool field(const char* name, const std::string& unit, const char* text) {
    using Type = typename Shown<T>::Type;
    suffix_ = Shown<T>::kList && Struct<Type> ? "[]" : json_fields::IsNamed<T>::value ? ".*" : "";
    std::string meaning = text;
    bool first = true;
    if constexpr (Struct<Type>) {
      // Unfolded where it first stands; later places refer to that.
      const auto [seen, added] = seen_.emplace(typeid(Type), path(name) + suffix_);
      first = added;
      if (!first) meaning += "; fields as in `" + seen->second + "`";
    }
    rows_ += "| `" + path(name) + suffix_ + "` | " + unit + " | " + escaped(meaning) + " |\n";
    return first;
  }
  void number(const char* /*name*/, const std::string& /*unit*/, double /*value*/) {}
  template <class T>
  void array(const char* name, const std::vector<T>& /*values*/, const char* text) {
    arrays_ += "| `" + path(name) + "` | `" + store_internal::describe<T>() + "` | " +
               escaped(text) + " |\n";
  }
  void enter(const char* name) {
    path_.push_back(name + suffix_);
    suffix_.clear();
  }
  void leave() { path_.pop_back(); }
  // No name of its own in a path: the list's "[]" stands for every element.
  void element(std::size_t /*index*/, const std::string& /*label*/) { path_.emplace_back(); }

  std::string take(const std::string& title) {
    std::string text = "\n## " + title + "\n\n| field | unit | meaning |\n|---|---|---|\n" + rows_;
    if (!arrays_.empty()) {
      text += "\nArrays of the store:\n\n| array | element | meaning |\n|---|---|---|\n" + arrays_;
    }
    rows_.clear();
    arrays_.clear();
    return text;
  }

 private:
  std::string path(const std::string& name) const {
    std::string text;
    for (const std::string& part : path_) text += part.empty() ? "" : part + ".";
    return text + name;
  }

  std::vector<std::string> path_;
  std::string suffix_, rows_, arrays_;
  std::map<std::type_index, std::string> seen_;
};

/// docs/records.md: the tables of all documents and arrays, from the field lists.
std::string fieldTables() {
  TableSink sink;
  std::string text = kIntroduction;
  CalibrationRecord calibration;
  // The covariances stand under `if (stage)`, which kAll does not open.
  calibration.camera.emplace();
  calibration.camera_imu.emplace();
  const auto add = [&](const auto& record, const char* title) {
    walkFields(sink, record);
    text += sink.take(title);
  };
  add(calibration, "calibration.json, evaluation.json");
  add(ComparisonRecord(), "comparison.json");
  add(PerturbationRecord(), "perturbation.json");
  add(TrajectoryRecord(), "trajectory.json");
  add(ReplayRecord(), "replay.json");
  add(StudyRecord(), "summary.json of a study");
  return text;
}

TEST(FieldTables, AreThoseOfTheDocumentation) {
  const std::string path = PLUMBLINE_SOURCE_DIR "/docs/records.md";
  if (std::getenv("PLUMBLINE_UPDATE_DOCS") != nullptr) std::ofstream(path) << fieldTables();
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(text == fieldTables()) << "set PLUMBLINE_UPDATE_DOCS=1 and run this test again";
}

}  // namespace
}  // namespace plumbline
