#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds, and runs every test: unit tests of what computes and of what reads files with
# AddressSanitizer and UBSan, all others with the program as it is shipped. Tests on real recordings (label
# real-data) need PLUMBLINE_SHARED_DATA (default: ../shared/data); without that folder they are left out, loudly.
# Further arguments go to ctest, e.g.  scripts/test.sh -L unit
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/build_environment.sh
data=${PLUMBLINE_SHARED_DATA:-$PWD/../shared/data}

scripts/test_sanitized.sh "$@"

cmake -S . -B build -G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Release -DPLUMBLINE_TESTS=ON \
  -DPLUMBLINE_LIBRARY_TESTS=OFF -DPLUMBLINE_SHARED_DATA="$data" >/dev/null
cmake --build build

left_out=()
if [ ! -d "$data" ]; then
  left_out=(-LE real-data)
  cat >&2 <<EOF
************************************************************************************
* No real recordings at $data
* The tests labelled real-data are LEFT OUT. Set PLUMBLINE_SHARED_DATA to run them.
************************************************************************************
EOF
fi
# One more at a time than there are processors: some wait for what they started.
ctest --test-dir build --output-on-failure -j "$(($(nproc) + 1))" "${left_out[@]}" "$@"
