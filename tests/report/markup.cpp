// SPDX-License-Identifier: BSD-3-Clause
#include "tests/report/markup.h"

#include <algorithm>
#include <regex>

namespace plumbline::test {
namespace {

bool entityAt(const std::string& xml, std::size_t at) {
  static const std::regex kEntity("^&(amp|lt|gt|quot|#[0-9]+|#x[0-9a-fA-F]+);");
  return std::regex_search(xml.substr(at, 12), kEntity);
}

}  // namespace

std::string faultOfXml(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&' && !entityAt(xml, i)) return "bare & at " + std::to_string(i);
    if (xml[i] != '<') continue;
    const std::size_t end = xml.find('>', i);
    if (end == std::string::npos) return "unclosed tag at " + std::to_string(i);
    const std::string tag = xml.substr(i + 1, end - i - 1);
    if (tag.find('<') != std::string::npos) return "bare < at " + std::to_string(i);
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "odd quotes in <" + tag + ">";
    const bool closing = tag[0] == '/';
    const std::string name =
        tag.substr(closing ? 1 : 0, tag.find_first_of(" /", 1) - (closing ? 1 : 0));
    if (closing && (open.empty() || open.back() != name)) return "stray </" + name + ">";
    if (closing) open.pop_back();
    if (!closing && tag.back() != '/') open.push_back(name);
    i = end;
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

std::vector<std::string> attributes(const std::string& xml, const std::string& name) {
  std::vector<std::string> values;
  const std::string start = " " + name + "=\"";
  for (std::size_t at = xml.find(start); at != std::string::npos; at = xml.find(start, at)) {
    at += start.size();
    values.push_back(xml.substr(at, xml.find('"', at) - at));
  }
  return values;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (*at != '\0') {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) {
      ++at;
    } else {
      values.push_back(value);
      at = end;
    }
  }
  return values;
}

AxisMapping::AxisMapping(const std::string& svg) {
  const auto found = attributes(svg, "data-ax");
  const auto values = found.size() == 1 ? numbers(found[0]) : std::vector<double>();
  if (values.size() == a.size()) std::copy(values.begin(), values.end(), a.begin());
}

}  // namespace plumbline::test
