#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy over the sources of the libraries and the command line, warnings are errors. Needs a
# configured build folder (first argument, default: build) for its compile_commands.json.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
[ -f "$build/compile_commands.json" ] || { echo "check_tidy.sh: configure $build first" >&2; exit 2; }
git ls-files -z -- 'calibrator/*.cpp' 'datasets/*.cpp' 'report/*.cpp' 'evaluate/*.cpp' |
  xargs -0 -n 4 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
