# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts that build, in the root of the repository.
# clang++ needs three fifths of g++'s time for these sources; what it makes is a twentieth slower for
# cameras and a sixth faster for camera-IMU (docs/benchmarks.md). CC and CXX choose otherwise; a folder
# keeps the compiler it was made with.
export CC=${CC:-clang} CXX=${CXX:-clang++}
# A clone in the same place finds what ccache keeps (one elsewhere finds little: sources compiled as one name their
# folders). What it does not know yet is not preprocessed first (an eighth of the time).
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1 CCACHE_SLOPPINESS=pch_defines,time_macros

# The build with AddressSanitizer and UBSan, in build-sanitized. Its reports name functions, those of UBSan lines, too;
# with SANITIZED_LINES=1 in the environment all do, and the sources of calibrator take an eighth longer to compile.
configure_sanitized() {
  local debug=-g0
  [ -z "${SANITIZED_LINES:-}" ] || debug="-g1 -mllvm -experimental-debug-variable-locations=false"
  cmake -S . -B build-sanitized -G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_CXX_FLAGS_DEBUG="$debug" -DPLUMBLINE_SANITIZE=ON -DPLUMBLINE_TESTS=ON >/dev/null
}
