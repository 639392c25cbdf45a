// SPDX-License-Identifier: BSD-3-Clause
// write_seeds FOLDER: FOLDER/PARSER/seeds/* with what each parser's seeds are, and its dictionary,
// FOLDER/PARSER/words: the words of its seeds that are text, and those it knows besides. Prints the
// parsers' names.
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "tests/fuzz/parser.h"

namespace {

using namespace plumbline::fuzz;

bool isWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

void addWords(const std::string& seed, std::set<std::string>& words) {
  constexpr std::size_t kLongest = 40;
  if (seed.find('\0') != std::string::npos) return;
  for (std::size_t at = 0; at < seed.size();) {
    std::size_t end = at;
    while (end < seed.size() && isWordCharacter(seed[end])) ++end;
    const bool letters = std::isalpha(static_cast<unsigned char>(seed[at])) != 0;
    if (letters && end - at > 1 && end - at <= kLongest) words.insert(seed.substr(at, end - at));
    at = std::max(at + 1, end);
  }
}

std::string dictionary(const Parser& parser, const std::vector<std::string>& seeds) {
  std::set<std::string> words(parser.words.begin(), parser.words.end());
  words.insert({"nan", "inf", "-1", "1e308", "1e-320", "2147483648", "9223372036854775807", "0"});
  for (const std::string& seed : seeds) addWords(seed, words);
  std::string text;
  for (const std::string& word : words) {
    text += '"';
    for (const char c : word) {
      char hex[5];
      std::snprintf(hex, sizeof hex, "\\x%02x", static_cast<unsigned char>(c));
      text += isWordCharacter(c) || c == ' ' ? std::string(1, c) : hex;
    }
    text += "\"\n";
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: write_seeds FOLDER\n", stderr), 2;
  for (const auto& [name, parser] : allParsers()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / name;
    std::filesystem::create_directories(folder / "seeds");
    const std::vector<std::string> seeds = parser.seeds();
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      writeBytes((folder / "seeds" / std::to_string(i)).string(), seeds[i]);
    }
    writeBytes((folder / "words").string(), dictionary(parser, seeds));
    std::puts(name.c_str());
  }
}
