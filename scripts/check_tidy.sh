#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy and g++ over the sources of the libraries and the command line, warnings are errors: the
# scripts build with clang++ and several sources at a time, here each stands alone. Needs a folder
# configured for g++ without PLUMBLINE_UNITY; it need not be built.
#
#   scripts/check_tidy.sh [BUILD]         what changed since the commit in .ci/tidied
#   scripts/check_tidy.sh [BUILD] --all   every file; when clean, put HEAD's commit into .ci/tidied
set -euo pipefail
cd "$(dirname "$0")/.."
build=build
which=
for argument in "$@"; do
  if [ "$argument" = --all ]; then which=--all; else build=$argument; fi
done
[ -f "$build/compile_commands.json" ] || { echo "check_tidy.sh: configure $build first" >&2; exit 2; }
# The list of files then names only what is compiled together, not each source.
if grep -q '^PLUMBLINE_UNITY:BOOL=ON' "$build/CMakeCache.txt"; then
  echo "check_tidy.sh: $build compiles several sources at a time; configure a folder without" \
    "PLUMBLINE_UNITY and name it" >&2
  exit 2
fi

files=$(scripts/changed_sources.sh $which)
count=$(printf '%s' "$files" | grep -c . || true)
echo "clang-tidy: $count files"
[ -z "$files" ] || printf '%s\n' "$files" |
  xargs -n 4 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
echo "g++: $count files"
[ -z "$files" ] || printf '%s\n' "$files" | python3 scripts/compile_alone.py "$build"
