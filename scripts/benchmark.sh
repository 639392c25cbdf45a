#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures Plumbline beside its rivals on the very same corners and prints one table. Installs mrcal
# and OpenCV from Debian. On a simulated recording, and on the EuRoC one where PLUMBLINE_SHARED_DATA
# (default ../shared/data) has it. One thread for everybody. Usage: scripts/benchmark.sh [--quick]
set -euo pipefail
cd "$(dirname "$0")/.."
data=${PLUMBLINE_SHARED_DATA:-$PWD/../shared/data}

scripts/install_dependencies.sh build bench
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build --target plumbline

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build/evaluate/plumbline simulate --out "$work/simulated" --rig euroc --seed 11 --duration 60 >/dev/null
sessions=("simulated=$work/simulated")
if [ -d "$data/euroc_imu_april" ]; then
  sessions+=("EuRoC=$data/euroc_imu_april")
else
  echo "No $data/euroc_imu_april: the EuRoC rows are left out" >&2
fi
/usr/bin/python3 scripts/benchmark/compare.py --plumbline build/evaluate/plumbline \
  --work "$work" "$@" "${sessions[@]}"
