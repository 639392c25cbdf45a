// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/files/manifest.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHashName = "xxh64:";
constexpr const char* kLinkName = "link:";

// Everything within a folder, sorted; links are not followed.
std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    entries.push_back(entry.path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

// The same but for what may not be read: enough to remove or move what is found, where an error
// would stop all that comes after.
std::vector<fs::path> readableEntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  const auto readable = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator it(folder, readable, error), end; !error && it != end;
       it.increment(error)) {
    entries.push_back(it->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool isFileOrLink(const fs::file_status& status) {
  return fs::is_regular_file(status) || fs::is_symlink(status);
}

ManifestEntry entryOf(const fs::path& file) {
  if (fs::is_symlink(fs::symlink_status(file))) {
    const std::string to = fs::read_symlink(file).string();
    return {to.size(), kLinkName + contentHash(to)};
  }
  const MappedFile content(file.string());
  return {content.text().size(), kHashName + contentHash(content.text())};
}

// The size first: it needs no reading.
bool isAsListed(const fs::path& file, const ManifestEntry& listed) {
  std::error_code error;
  const bool link = fs::is_symlink(fs::symlink_status(file, error));
  if (!link && (fs::file_size(file, error) != listed.bytes || error)) return false;
  try {
    return entryOf(file).hash == listed.hash;
  } catch (const std::runtime_error&) {  // InputError, or of a link that has just gone
    return false;
  }
}

bool areSameLinks(const fs::path& a, const fs::path& b) {
  std::error_code error;
  const fs::path to = fs::read_symlink(a, error);
  if (error) return false;
  return fs::read_symlink(b, error) == to && !error;
}

// Folders that the listed files lie in.
std::set<std::string> foldersOf(const Manifest& manifest) {
  std::set<std::string> folders;
  for (const auto& [name, entry] : manifest.files) {
    for (fs::path at = fs::path(name).parent_path(); !at.empty(); at = at.parent_path()) {
      folders.insert(at.generic_string());
    }
  }
  return folders;
}

std::optional<Manifest> parse(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  try {
    if (json.at("program") != "plumbline" || json.at("schema") != 1) return std::nullopt;
    Manifest manifest{json.at("version"), json.at("kind"), {}};
    for (const auto& [name, entry] : json.at("files").items()) {
      manifest.files[name] = {entry.at("bytes"), entry.at("hash")};
    }
    return manifest;
  } catch (const nlohmann::json::exception&) {  // not of this form: not ours
    return std::nullopt;
  }
}

}  // namespace

Manifest manifestOf(const fs::path& folder, const std::string& version, const std::string& kind) {
  Manifest manifest{version, kind, {}};
  for (const fs::path& path : entriesOf(folder)) {
    if (!isFileOrLink(fs::symlink_status(path))) continue;
    manifest.files[path.lexically_relative(folder).generic_string()] = entryOf(path);
  }
  return manifest;
}

std::string manifestText(const Manifest& manifest) {
  nlohmann::ordered_json files = nlohmann::ordered_json::object();
  for (const auto& [name, entry] : manifest.files) {
    files[name] = {{"bytes", entry.bytes}, {"hash", entry.hash}};
  }
  return nlohmann::ordered_json{{"schema", 1},
                                {"program", "plumbline"},
                                {"version", manifest.version},
                                {"kind", manifest.kind},
                                {"files", files}}
             .dump(2) +
         "\n";
}

std::optional<Manifest> readManifest(const fs::path& folder) {
  const fs::path path = folder / kManifestFile;
  std::error_code unreadable;
  if (!fs::is_regular_file(fs::symlink_status(path, unreadable))) return std::nullopt;
  try {
    return parse(MappedFile(path.string()).text());
  } catch (const InputError&) {  // gone meanwhile, or unreadable
    return std::nullopt;
  }
}

std::optional<ForeignEntry> firstForeign(const fs::path& folder, const Manifest& manifest) {
  const std::set<std::string> folders = foldersOf(manifest);
  for (const fs::path& path : entriesOf(folder)) {
    const std::string name = path.lexically_relative(folder).generic_string();
    const fs::file_status status = fs::symlink_status(path);
    if (fs::is_directory(status)) {
      if (folders.count(name) == 0) return ForeignEntry{path, false};
      continue;
    }
    // It does not list itself.
    if (fs::is_regular_file(status) && name == kManifestFile) continue;
    const auto listed = manifest.files.find(name);
    if (listed == manifest.files.end()) return ForeignEntry{path, false};
    // Changed is foreign too: a user's edit of a result is not thrown away by the next run.
    if (!isFileOrLink(status) || !isAsListed(path, listed->second)) {
      return ForeignEntry{path, true};
    }
  }
  return std::nullopt;
}

void moveUnlisted(const fs::path& folder, const Manifest& manifest, const fs::path& to) {
  for (const fs::path& path : readableEntriesOf(folder)) {
    const std::string name = path.lexically_relative(folder).generic_string();
    if (name == kManifestFile || manifest.files.count(name) > 0) continue;
    const fs::path place = to / name;
    std::error_code unknown, stays;
    if (areSameLinks(path, place)) fs::remove(path, stays);
    const fs::file_status there = fs::symlink_status(place, unknown);
    if (fs::is_directory(fs::symlink_status(path, unknown)) || fs::exists(there)) continue;
    // A file of the new result may have the name of a folder: then that place is taken too.
    std::error_code taken;
    fs::create_directories(place.parent_path(), taken);
    if (taken == std::errc::not_a_directory || taken == std::errc::file_exists) continue;
    fs::rename(path, place, stays);
  }
}

void removeListed(const fs::path& folder, const Manifest& manifest) {
  std::error_code ignored;
  // The manifest goes last: as long as a file is there, it says whose it is.
  const std::vector<fs::path> entries = readableEntriesOf(folder);
  for (const fs::path& path : entries) {
    const std::string name = path.lexically_relative(folder).generic_string();
    const fs::file_status status = fs::symlink_status(path, ignored);
    if (isFileOrLink(status) && manifest.files.count(name) > 0) fs::remove(path, ignored);
  }
  // Backwards: what lies in a folder goes before it. Only empty ones are removed.
  for (auto path = entries.rbegin(); path != entries.rend(); ++path) {
    if (fs::is_directory(fs::symlink_status(*path, ignored))) fs::remove(*path, ignored);
  }
  // It stays beside what is somebody else's: without it, all would count as the program's.
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename() != kManifestFile) return;
  }
  fs::remove(folder / kManifestFile, ignored);
  fs::remove(folder, ignored);
}

}  // namespace plumbline
