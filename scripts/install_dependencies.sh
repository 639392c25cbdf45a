#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what Plumbline needs from Debian 12's own packages. Nothing is asked and nothing else is
# touched; packages that are there already are left alone. Usage:
#   scripts/install_dependencies.sh [build|bag|test|sanitize|check|bench|slurm]...   (default: build)
set -euo pipefail

build_packages=(
  git ca-certificates clang lld cmake ninja-build ccache libjemalloc2 pkg-config
  libboost-dev libeigen3-dev libsuitesparse-dev
  libapriltag-dev libvtk9-dev
  libpng-dev libjpeg62-turbo-dev libcairo2-dev libxxhash-dev zlib1g-dev liblz4-dev libzstd-dev
  libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libfmt-dev libtbb-dev
  libsqlite3-dev libsqlitecpp-dev libkainjow-mustache-dev
  libgtest-dev libgmock-dev)
bag_packages=(librosbag-storage-dev)
test_packages=("${bag_packages[@]}" chromium fish fonts-dejavu-core python3 libbenchmark-dev libceres-dev libopencv-core-dev
  libopencv-imgproc-dev libopencv-calib3d-dev zsh)
sanitize_packages=(libclang-rt-dev)
check_packages=(clang-format clang-tidy g++ python3)
bench_packages=(libbenchmark-dev mrcal python3 python3-mrcal python3-numpy python3-opencv time)
slurm_packages=(munge python3 slurm-wlm)

wanted=()
for set_name in "${@:-build}"; do
  case "$set_name" in
    build) wanted+=("${build_packages[@]}") ;;
    bag) wanted+=("${bag_packages[@]}") ;;
    test) wanted+=("${test_packages[@]}") ;;
    sanitize) wanted+=("${sanitize_packages[@]}") ;;
    check) wanted+=("${check_packages[@]}") ;;
    bench) wanted+=("${bench_packages[@]}") ;;
    slurm) wanted+=("${slurm_packages[@]}") ;;
    *) echo "install_dependencies.sh: unknown set '$set_name' (build, bag, test, sanitize, check, bench, slurm)" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install_dependencies.sh: run as root or install sudo" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { "${as_root[@]}" apt-get update -q &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
         apt-get install -q -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
  tail -n 30 "$log" >&2
  echo "install_dependencies.sh: apt-get failed; the lines above say why" >&2
  exit 1
fi
