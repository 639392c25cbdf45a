#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The sources of the libraries and the command line that a check has to look at, a line each.
#
#   scripts/changed_sources.sh         what changed since the commit in .ci/tidied (all files where that
#                                      commit is not in the clone)
#   scripts/changed_sources.sh --all   every file
set -euo pipefail
cd "$(dirname "$0")/.."

sources=(calibrator datasets report evaluate)
every() { git ls-files -- "${sources[@]}" | grep '\.cpp$'; }
# Changed sources, and for a changed header the source beside it or else one that includes it.
changed() {
  git diff --name-only --diff-filter=d "$1" -- "${sources[@]}" | while read -r file; do
    case $file in
      *.cpp) echo "$file" ;;
      *.h)
        if [ -f "${file%.h}.cpp" ]; then echo "${file%.h}.cpp"
        else git grep -l -F "\"$file\"" -- "${sources[@]}" | grep -m 1 '\.cpp$' || true; fi ;;
    esac
  done | sort -u
}

base=$(cat .ci/tidied 2>/dev/null || true)
if [ "${1:-}" = --all ] || ! git cat-file -e "$base^{commit}" 2>/dev/null; then every
else changed "$base"; fi
