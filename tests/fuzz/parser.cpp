// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/parser.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "calibrator/base/error.h"

namespace plumbline::fuzz {

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "plumbline_fuzz_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category());
  folder_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void writeBytes(const std::string& path, std::string_view bytes) {
  // System calls: of a reader's few microseconds a stream would take half. Cut at the end and not
  // at the start: the file keeps its pages.
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const ssize_t written = file < 0 ? -1 : ::write(file, bytes.data(), bytes.size());
  const bool cut = file >= 0 && ::ftruncate(file, static_cast<off_t>(bytes.size())) == 0;
  if (file >= 0) ::close(file);
  if (!cut || written != static_cast<ssize_t>(bytes.size())) {
    throw std::logic_error(path + ": " + std::strerror(errno));
  }
}

std::string readBytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

bool sameText(const std::string& a, const std::string& b) {
  const auto numeric = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) || c == '-';
  };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (numeric(a[i]) && numeric(b[j])) {
      char* end_a = nullptr;
      char* end_b = nullptr;
      const double x = std::strtod(&a[i], &end_a);
      const double y = std::strtod(&b[j], &end_b);
      const bool same_words =  // "-nan", say, which equals no number
          std::equal(a.data() + i, static_cast<const char*>(end_a), b.data() + j,
                     static_cast<const char*>(end_b));
      const bool close = x == y || std::abs(x - y) <= 1e-9 * std::max(1.0, std::abs(x));
      if (!same_words && !close) return false;
      // A minus sign alone is no number.
      i = std::max(i + 1, static_cast<std::size_t>(end_a - a.data()));
      j = std::max(j + 1, static_cast<std::size_t>(end_b - b.data()));
    } else if (a[i++] != b[j++]) {
      return false;
    }
  }
  return i == a.size() && j == b.size();
}

bool accepts(const Parser& parser, const Scratch& scratch, std::string_view bytes) {
  const std::string path = scratch.path(parser.file);
  writeBytes(path, bytes);
  try {
    parser.read(path);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace plumbline::fuzz
