// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline::fuzz {

/// A reader of files as it is run on random bytes. Nothing but InputError may leave `read`: it says
/// that the input is bad. What crashes, hangs or throws anything else is a fault of the reader.
struct Parser {
  /// Reads the file; throws Unstable where what was read is written and then reads otherwise.
  std::function<void(const std::string& path)> read;
  /// Contents of good files, as the project's writers make them where there is one.
  std::function<std::vector<std::string>()> seeds;
  /// Words that the reader knows and no seed holds, for the dictionary.
  std::vector<std::string> words = {};
  /// Name that the reader wants its file to have.
  std::string file = "input";
};

// All parsers, by the names that tests/fuzz/fuzz.cmake lists.
#define PLUMBLINE_PARSER(name) Parser name();
#include "generated/fuzz/parser_list.inc"
#undef PLUMBLINE_PARSER

struct NamedParser {
  std::string name;
  Parser parser;
};

/// Tests show the name.
inline void PrintTo(const NamedParser& named, std::ostream* stream) { *stream << named.name; }

std::vector<NamedParser> allParsers();

/// What was read, written and read again is not what it was.
struct Unstable : std::logic_error {
  using std::logic_error::logic_error;
};

/// A folder for the parser's file, gone at the end. Below TMPDIR, which had better be in memory.
class Scratch {
 public:
  Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch();

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

/// Writes the bytes, over an older file.
void writeBytes(const std::string& path, std::string_view bytes);
std::string readBytes(const std::string& path);

/// Whether the parser accepts the bytes; false: it refused them by an InputError.
bool accepts(const Parser& parser, const Scratch& scratch, std::string_view bytes);

/// Whether the texts are equal but for numbers in them, which differ by no more than 1e-9, relative
/// to those above 1: a rotation that is made orthonormal again moves by its last digits.
bool sameText(const std::string& a, const std::string& b);

/// Throws Unstable unless what `read` makes of write(value), put into a file beside `path`, is
/// written as the same text.
template <class Value, class Write, class Read>
void expectStable(const std::string& path, const Value& value, const Write& write,
                  const Read& read) {
  const std::string copy = path + ".again";
  const std::string text = write(value);
  writeBytes(copy, text);
  std::string again;
  try {
    again = write(read(copy));
  } catch (const std::runtime_error& refusal) {
    throw Unstable("what was written is refused: " + std::string(refusal.what()) + "\n" + text);
  }
  if (!sameText(again, text))
    throw Unstable("what was written reads otherwise:\n" + text + "\n" + again);
}

}  // namespace plumbline::fuzz
