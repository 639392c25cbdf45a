#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures Plumbline beside mrcal and OpenCV on the very same corners and prints two tables: what was
# measured, and the figures against the project's bars. Installs mrcal and OpenCV from Debian. Works
# on a simulated recording, and on the EuRoC ones where PLUMBLINE_SHARED_DATA (default
# ../shared/data) has them. One thread for everybody; about 5 minutes after the build, and
# the studies' nights on top (about 480 s of CPU per 100 sessions).
# Usage: scripts/benchmark.sh [--quick]     (--quick: one run of each, without OpenCV)
# BUILD names another build folder than build/.
set -euo pipefail
cd "$(dirname "$0")/.."
data=${PLUMBLINE_SHARED_DATA:-$PWD/../shared/data}
build=${BUILD:-build}
source scripts/build_environment.sh

scripts/install_dependencies.sh build test bench
cmake -S . -B "$build" -G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Release -DPLUMBLINE_TESTS=ON >/dev/null
cmake --build "$build" --target plumbline detector_benchmark guidance_views_benchmark \
  guidance_trajectories_benchmark >&2

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
plumbline=$build/evaluate/plumbline
"$plumbline" simulate --out "$work/simulated" --rig euroc --seed 11 --duration 60 >/dev/null
"$plumbline" simulate --out "$work/images" --rig euroc --seed 11 --duration 2 --images >/dev/null
arguments=("simulated=$work/simulated" --images "simulated=$work/images")
if [ -d "$data/euroc_imu_april" ]; then
  arguments+=("EuRoC=$data/euroc_imu_april")
else
  echo "No $data/euroc_imu_april: the EuRoC rows are left out" >&2
fi
if [ -d "$data/euroc_cam_april_images" ]; then
  arguments+=(--images "EuRoC=$data/euroc_cam_april_images")
else
  echo "No $data/euroc_cam_april_images: real images are left out" >&2
fi
/usr/bin/python3 scripts/benchmark/compare.py --plumbline "$plumbline" \
  --detector-benchmark "$build/tests/benchmarks/detector_benchmark" --work "$work" \
  "$@" "${arguments[@]}"

# Trajectories: beside evo's work in numpy.
estimate=$data/trajectories/vio_stereo_V2_02_stamped_traj_estimate.txt
truth=$data/trajectories/V2_02_medium.txt
if [ -f "$estimate" ] && [ -f "$truth" ]; then
  echo
  /usr/bin/python3 scripts/benchmark/trajectories.py --plumbline "$plumbline" "$estimate" "$truth"
else
  echo "No $data/trajectories: trajectory errors are left out" >&2
fi

# Projection uncertainty and difference: beside mrcal's, on the same corners.
for session in "$data/euroc_imu_april" "$work/simulated"; do
  [ -d "$session" ] || continue
  printf '\n%s:\n\n' "$(basename "$session")"
  /usr/bin/python3 scripts/benchmark/projections.py --plumbline "$plumbline" "$session"
done

# Guidance: candidates, trajectories and steps of both stages, one thread, with percentiles.
for stage in views trajectories; do
  echo
  "$build/tests/benchmarks/guidance_${stage}_benchmark" 2>/dev/null
done

# Odometry, frame by frame: rendered images, tracks alone, and EuRoC's.
odometry=()
if [ -d "$data/euroc_mh01_17s" ]; then
  odometry=("EuRoC=$data/euroc_mh01_17s=$data/euroc_imu_april/kalibr/camchain-imucam.yaml")
fi
echo
/usr/bin/python3 scripts/benchmark/odometry.py --plumbline "$plumbline" --work "$work" "$@" \
  "${odometry[@]}"

# A study's nights: how they grow with its sessions. --quick: a small one alone.
sizes=26,50,100
case " $* " in *" --quick "*) sizes=8 ;; esac
echo
/usr/bin/python3 scripts/benchmark/study.py --plumbline "$plumbline" --sessions "$sizes"
