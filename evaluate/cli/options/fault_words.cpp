// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "evaluate/cli/options/simulation_options.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

/// A unit as it is written and its size in SI units; an empty word: the unit may be left out.
struct Unit {
  std::string_view word;
  double size = 1;
};

/// A quantity as the forms name it.
struct QuantityWords {
  Quantity quantity;
  const char* symbol;
  std::vector<Unit> units;
};

const std::vector<QuantityWords>& quantityWords() {
  static const std::vector<QuantityWords> words{
      {Quantity::kFactor, "FACTOR", {{"", 1}}},
      {Quantity::kShare, "SHARE", {{"%", 0.01}, {"", 1}}},
      {Quantity::kAngle, "ANGLE", {{"deg", kDegree}, {"rad", 1}}},
      {Quantity::kTime, "TIME", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}}},
      {Quantity::kDrift, "DRIFT", {{"ppm", 1e-6}}},
      {Quantity::kLength, "LENGTH", {{"mm", 1e-3}, {"m", 1}}},
      {Quantity::kFrequency, "FREQUENCY", {{"Hz", 1}}},
      {Quantity::kRate, "RATE", {{"/min", 1.0 / 60}, {"/s", 1}}},
      {Quantity::kAcceleration, "ACCELERATION", {{"m/s2", 1}, {"", 1}}},
      {Quantity::kAngularRate, "ANGULAR_RATE", {{"rad/s", 1}, {"deg/s", kDegree}, {"", 1}}},
      {Quantity::kGyroPerAccel, "SENSITIVITY", {{"", 1}}},
      {Quantity::kPixels, "PIXELS", {{"px", 1}, {"", 1}}},
      {Quantity::kCount, "COUNT", {{"", 1}}},
  };
  return words;
}

const QuantityWords& wordsOf(Quantity quantity) {
  return *findBy(quantityWords(), &QuantityWords::quantity, quantity);
}

/// "deg or rad", "m/s2, or none".
std::string unitsOf(Quantity quantity) {
  const std::vector<Unit>& units = wordsOf(quantity).units;
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i > 0) text += i + 1 == units.size() ? " or " : ", ";
    text += units[i].word.empty() ? "without unit" : units[i].word;
  }
  return text;
}

/// "=ANGLE", "[,SHARE]": in brackets what has a usual value and may be left out.
std::string valueForm(const FaultValue& value, const char* before) {
  if (value.quantity == Quantity::kNone) return "";
  const std::string form = std::string(before) + wordsOf(value.quantity).symbol;
  return value.usual ? "[" + form + "]" : form;
}

/// "slip=ANGLE@TIME[,x|y|z]".
std::string formOf(const FaultDescription& d) {
  // A board stretches in its plane alone.
  return d.name + valueForm(d.value, "=") + valueForm(d.extent, ",") +
         (d.instant == TakesInstant::kYes ? "@TIME" : "") +
         (takesAxis(d.key) ? (d.kind == FaultKind::kStretch ? "[,x|y]" : "[,x|y|z]") : "") +
         (takesCamera(d.key) ? "[,camN]" : "");
}

[[noreturn]] void refuse(const std::string& spec, const FaultDescription& d,
                         const std::string& what) {
  std::string units;
  for (const FaultValue* value : {&d.value, &d.extent}) {
    if (value->quantity == Quantity::kNone) continue;
    units += fmt::format(", {} in {}", wordsOf(value->quantity).symbol, unitsOf(value->quantity));
  }
  throw InputError(fmt::format("--fault {}: {}; expected {}{}, e.g. {}", spec, what, formOf(d),
                               units, d.example));
}

/// A number as it was written and the unit it was written in.
struct Amount {
  double number = 0;
  Unit unit;
  double value() const { return number * unit.size; }
};

std::optional<Amount> amountFrom(std::string_view word, Quantity quantity) {
  double number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  // What is left has to be a unit in full: "5 ms" and "5msec" are none.
  const std::string_view suffix(end, static_cast<std::size_t>(word.data() + word.size() - end));
  for (const Unit& unit : wordsOf(quantity).units) {
    if (unit.word == suffix) return Amount{number, unit};
  }
  return std::nullopt;
}

/// 0, 1, 2 of "x", "y", "z".
std::optional<int> axisFrom(std::string_view word) {
  if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
  return word[0] - 'x';
}

/// 1 of "cam1".
std::optional<int> cameraFrom(std::string_view word) {
  if (word.size() < 4 || word.size() > 6 || word.substr(0, 3) != "cam") return std::nullopt;
  int index = 0;
  const auto [end, error] = std::from_chars(word.data() + 3, word.data() + word.size(), index);
  if (error != std::errc() || end != word.data() + word.size() || index < 0) return std::nullopt;
  return index;
}

/// A spec in its parts.
struct Words {
  std::string_view name;
  std::vector<std::string_view> list;  // what commas part, after the "="
  std::vector<std::string_view> instants;
};

Words partsOf(std::string_view spec) {
  Words words;
  std::vector<std::string_view> parts;
  for (std::size_t from = 0; from <= spec.size();) {
    const std::size_t to = std::min(spec.find(',', from), spec.size());
    parts.push_back(spec.substr(from, to - from));
    from = to + 1;
  }
  for (std::string_view& part : parts) {
    // An instant may follow any part, as people write it: slip=0.2deg@15s,x and slip=0.2deg,x@15s.
    const std::size_t at = part.find('@');
    if (at == std::string_view::npos) continue;
    words.instants.push_back(part.substr(at + 1));
    part = part.substr(0, at);
  }
  const std::size_t equals = parts.front().find('=');
  words.name = parts.front().substr(0, equals);
  if (equals != std::string_view::npos) words.list.push_back(parts.front().substr(equals + 1));
  words.list.insert(words.list.end(), parts.begin() + 1, parts.end());
  return words;
}

const FaultDescription& descriptionOf(const std::string& spec, std::string_view name) {
  const auto all = faultDescriptions();
  if (const auto* known = findBy(all, &FaultDescription::name, name)) return *known;
  throw InputError(fmt::format(
      "--fault {}: unknown fault; expected one of {}; --fault list describes them", spec,
      joined(all, [](const FaultDescription& d) { return std::string(d.name); })));
}

/// The instant [s], where the fault has one.
double instantFrom(const std::string& spec, const FaultDescription& d, const Words& words) {
  const std::size_t count = d.instant == TakesInstant::kYes ? 1 : 0;
  if (words.instants.size() != count) {
    refuse(spec, d, count == 0 ? "it takes no time (@TIME)" : "it needs one time (@TIME)");
  }
  if (count == 0) return 0;
  const auto at = amountFrom(words.instants.front(), Quantity::kTime);
  if (!at) refuse(spec, d, fmt::format("'{}' is not a time", words.instants.front()));
  return at->value();
}

/// A value within its range, which a refusal states in the unit that was written.
double valueFrom(const std::string& spec, const FaultDescription& d, std::string_view word,
                 const FaultValue& value) {
  const auto given = amountFrom(word, value.quantity);
  if (!given) {
    refuse(spec, d, fmt::format("'{}' is not a value of {}", word, wordsOf(value.quantity).symbol));
  }
  // Said here in the unit that was written; check() knows SI alone.
  if (given->value() < value.low || given->value() > value.high) {
    const Unit& unit = given->unit;
    refuse(spec, d,
           fmt::format("'{}' is out of range ({:.6g} to {:.6g} {})", word, value.low / unit.size,
                       value.high / unit.size, unit.word));
  }
  return given->value();
}

/// Takes the numbers in their order; those left out have their usual values.
void setValues(const std::string& spec, const FaultDescription& d,
               const std::vector<std::string_view>& numbers, Fault& fault) {
  std::size_t next = 0;
  for (const bool second : {false, true}) {
    const FaultValue& value = second ? d.extent : d.value;
    if (value.quantity == Quantity::kNone) continue;
    double& target = second ? fault.extent : fault.value;
    if (next == numbers.size()) {
      if (!value.usual) {
        refuse(spec, d, fmt::format("{} is missing", wordsOf(value.quantity).symbol));
      }
      target = *value.usual;
      continue;
    }
    target = valueFrom(spec, d, numbers[next], value);
    ++next;
  }
  if (next < numbers.size())
    refuse(spec, d, fmt::format("'{}' is one value too many", numbers[next]));
}

}  // namespace

Fault faultFrom(const std::string& spec) {
  const Words words = partsOf(spec);
  const FaultDescription& d = descriptionOf(spec, words.name);
  Fault fault;
  fault.kind = d.kind;
  fault.spec = spec;
  fault.at_s = instantFrom(spec, d, words);
  std::vector<std::string_view> numbers;
  for (const std::string_view word : words.list) {
    const auto axis = axisFrom(word);
    const auto camera = cameraFrom(word);
    // In any order among the numbers. A second axis or camera, and one where the fault has none,
    // falls through to the refusal.
    if (takesAxis(d.key) && axis && !fault.axis) {
      fault.axis = axis;
    } else if (takesCamera(d.key) && camera && !fault.camera) {
      fault.camera = camera;
    } else if (axis || camera) {
      refuse(spec, d, fmt::format("'{}' is not expected there", word));
    } else {
      numbers.push_back(word);
    }
  }
  setValues(spec, d, numbers, fault);
  return fault;
}

std::string faultList() {
  std::string text;
  for (const FaultDescription& d : faultDescriptions()) {
    text += fmt::format("{:<46} e.g. {}\n    {}{}.\n", formOf(d), d.example, d.sentence,
                        d.images == InImages::kNo ? " (not with --images)" : "");
  }
  text += "\nUnits:\n";
  for (const QuantityWords& words : quantityWords()) {
    text += fmt::format("    {:<13} {}\n", words.symbol, unitsOf(words.quantity));
  }
  return text;
}

}  // namespace plumbline
