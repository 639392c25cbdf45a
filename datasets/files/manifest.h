// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace plumbline {

/// What marks a folder as a result of this program, and names what belongs to it.
inline constexpr const char* kManifestFile = "plumbline.json";

struct ManifestEntry {
  std::uint64_t bytes = 0;
  std::string hash;  ///< "xxh64:" and 16 hexadecimal digits; of a symbolic link, which is never
                     ///< followed, "link:" and those of the path that it holds
};

/// plumbline.json of a result folder:
///   {"schema": 1, "program": "plumbline", "version": ..., "kind": ...,
///    "files": {"mav0/cam0/data.csv": {"bytes": ..., "hash": "xxh64:..."}, ...}}
struct Manifest {
  std::string version;                         ///< of the program
  std::string kind;                            ///< of the result, e.g. "calibration"
  std::map<std::string, ManifestEntry> files;  ///< by path within the folder, with '/'
};

/// The manifest of all files and links that lie in `folder` now.
Manifest manifestOf(const std::filesystem::path& folder, const std::string& version,
                    const std::string& kind);

std::string manifestText(const Manifest& manifest);

/// The manifest of a folder; empty where it has none that this program wrote.
std::optional<Manifest> readManifest(const std::filesystem::path& folder);

/// The first (by name) of the files, links and folders within `folder` that is not as the manifest
/// has it: not listed, of another kind, or changed. `changed`: it is listed.
struct ForeignEntry {
  std::filesystem::path path;
  bool changed = false;
};
std::optional<ForeignEntry> firstForeign(const std::filesystem::path& folder,
                                         const Manifest& manifest);

/// Moves the files and links within `folder` that the manifest does not list to the same places
/// within `to`, but for those whose place is taken there, or that cannot be moved. Removes a link
/// whose place has the same link: manifests of earlier versions do not list a result's own.
void moveUnlisted(const std::filesystem::path& folder, const Manifest& manifest,
                  const std::filesystem::path& to);

/// Removes the files and links that the manifest lists, and the folders that are empty then.
/// Whatever else lies there stays, with the folder that holds it and the manifest, which tells
/// whose it is.
void removeListed(const std::filesystem::path& folder, const Manifest& manifest);

}  // namespace plumbline
