#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The unit tests (ctest label `unit`) in a build with AddressSanitizer and UBSan.
# Further arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/build_environment.sh
scripts/install_dependencies.sh build test sanitize
configure_sanitized
cmake --build build-sanitized --target calibrator_test datasets_test fuzz_test
# The leak checker is off where a debugger or container forbids ptrace; faults still abort.
LSAN_OPTIONS=suppressions=$PWD/tests/leaks.supp:print_suppressions=0 \
  ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1} UBSAN_OPTIONS=print_stacktrace=1 \
  ctest --test-dir build-sanitized --output-on-failure -j "$(nproc)" -L unit "$@"
