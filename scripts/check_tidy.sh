#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy over the sources of the libraries and the command line, warnings are errors. Needs a
# configured build folder for its compile_commands.json.
#
#   scripts/check_tidy.sh [BUILD]         what changed since the commit in .ci/tidied (all files where
#                                         that commit is not in the clone)
#   scripts/check_tidy.sh [BUILD] --all   every file; when clean, put HEAD's commit into .ci/tidied
set -euo pipefail
cd "$(dirname "$0")/.."
build=build
all=no
for argument in "$@"; do
  if [ "$argument" = --all ]; then all=yes; else build=$argument; fi
done
[ -f "$build/compile_commands.json" ] || { echo "check_tidy.sh: configure $build first" >&2; exit 2; }
# The list of files then names only what is compiled together, not each source.
if grep -q '^PLUMBLINE_UNITY:BOOL=ON' "$build/CMakeCache.txt"; then
  echo "check_tidy.sh: $build compiles several sources at a time; configure a folder without" \
    "PLUMBLINE_UNITY and name it" >&2
  exit 2
fi

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
if [ "$all" = yes ] || ! git cat-file -e "$base^{commit}" 2>/dev/null; then files=$(every)
else files=$(changed "$base"); fi
echo "clang-tidy: $(printf '%s' "$files" | grep -c . || true) files"
[ -z "$files" ] || printf '%s\n' "$files" |
  xargs -n 4 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
