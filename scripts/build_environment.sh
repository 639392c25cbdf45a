# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts that build, in the root of the repository.
# clang++ needs about half of g++'s time for these sources, and what it makes is no slower
# (docs/benchmarks.md). CC and CXX choose otherwise; a folder keeps the compiler it was made with.
export CC=${CC:-clang} CXX=${CXX:-clang++}
# Two clones share what ccache keeps.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
