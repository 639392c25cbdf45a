# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts that build, in the root of the repository.
# clang++ needs three fifths of g++'s time for these sources; what it makes is a twentieth slower for
# cameras and a sixth faster for camera-IMU (docs/benchmarks.md). CC and CXX choose otherwise; a folder
# keeps the compiler it was made with.
export CC=${CC:-clang} CXX=${CXX:-clang++}
# Two clones share what ccache keeps. What it does not know yet is not preprocessed first (an eighth of the time).
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1 CCACHE_SLOPPINESS=pch_defines,time_macros
# build FOLDER [arguments of cmake --build]. Compilers fill gigabytes: in large pages a twentieth less time.
build() { GLIBC_TUNABLES=glibc.malloc.hugetlb=1 cmake --build "$@"; }
