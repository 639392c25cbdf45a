#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fails where a source file differs from what clang-format would write (--fix rewrites them).
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(--dry-run -Werror)
[ "${1:-}" = --fix ] && mode=(-i)
git ls-files -z -- '*.cpp' '*.h' | xargs -0 -r -n 64 -P "$(nproc)" clang-format "${mode[@]}"
