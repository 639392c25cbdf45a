#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From a fresh Debian 12 machine to a calibration report and a study's page: installs, builds, records a
# small simulated session with images, calibrates it as if it were real, then makes a small user study and
# evaluates it as a night would. Everything is written below ./demo (or the folder given as first argument).
set -euo pipefail
out=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")/.."
source scripts/build_environment.sh
out=${out:-demo}

scripts/install_dependencies.sh build
echo "Building ..."
cmake -S . -B build -G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Release \
  -DPLUMBLINE_TESTS=OFF >/dev/null
cmake --build build --target plumbline

mkdir -p "$out"
echo
echo "Simulating a stereo camera-IMU recording with images ..."
build/evaluate/plumbline simulate --out "$out/session" --force --rig euroc --seed 7 --duration 20 \
  --camera-rate 10 --images
echo
echo "Calibrating it from the images alone ..."
build/evaluate/plumbline calibrate "$out/session" --out "$out/calibration" --force --cache "$out/cache" \
  --resample 20
echo
echo "Simulating a user study of four participants, with and without guidance ..."
build/evaluate/plumbline simulate study --participants 4 --duration 10 --sequences 1 --out "$out/study" --force
echo
echo "Evaluating it as every night would ..."
# A demo has no nights before, of other programs, to be worse than.
[ ! -e "$out/night/plumbline-study.json" ] || rm -rf "$out/night"
build/evaluate/plumbline study "$out/study/STUDY.yaml" --out "$out/night"
