#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs every fuzzer of tests/fuzz for some seconds, as many at a time as there are processors. Usage:
#   scripts/fuzz.sh [SECONDS [PARSER...]]    (default: 10 s each, all parsers)
#   scripts/fuzz.sh --runs RUNS [PARSER...]  so many executions each
# FUZZ_SEED=1 (a whole number above 0) in the environment: the same inputs every time, as long as the corpora are
# the same. Otherwise others every time.
# What they find grows in build-sanitized/fuzz/PARSER/corpus, from run to run. An input that makes a parser
# crash, throw anything but InputError, take more than a second or more than 512 MB is kept in
# build-sanitized/fuzz/PARSER/findings; exit 1. docs/fuzzing.md says what to do then.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/build_environment.sh
limit=(-max_total_time=10)
case "${1:-}" in
  --runs) limit=(-runs="$2"); shift 2 ;;
  [0-9]*) limit=(-max_total_time="$1"); shift ;;
esac
scripts/install_dependencies.sh build test sanitize
configure_sanitized
cmake --build build-sanitized --target fuzzers

folder=$PWD/build-sanitized/fuzz
scratch=$(mktemp -d -p "$([ -w /dev/shm ] && echo /dev/shm || echo /tmp)")  # each input is a file: in memory
trap 'rm -rf "$scratch"' EXIT
export TMPDIR=$scratch
# A freed byte is kept for a while, so that a late access is seen: 256 MB of it unless said otherwise. One input
# needs less than 1 MB; that, allocations without their stack and without a pattern in fresh memory are a third
# faster (stacks and pattern are there when a finding is run alone).
# Leaks are looked for by fuzz/parsers_test, on all seeds and regressions: after single executions the leak
# checker was seen to spin for minutes.
fast=quarantine_size_mb=1:thread_local_quarantine_size_kb=256:malloc_context_size=0:max_malloc_fill_size=0
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=0}:$fast UBSAN_OPTIONS=print_stacktrace=1
known=$(build-sanitized/tests/write_seeds "$folder")
for parser in "$@"; do
  grep -qxF -- "$parser" <<<"$known" || { echo "fuzz.sh: no parser '$parser'; there are: ${known//$'\n'/ }" >&2; exit 2; }
done

fuzz_one() {
  local at=$1/$2
  mkdir -p "$at/corpus" "$at/findings"
  local corpora=("$at/corpus" "$at/seeds")
  [ ! -d "tests/fuzz/regressions/$2" ] || corpora+=("tests/fuzz/regressions/$2")
  if build-sanitized/tests/fuzz_parser "--parser=$2" -dict="$at/words" -artifact_prefix="$at/findings/" \
    -seed="${FUZZ_SEED:-0}" -timeout=5 -report_slow_units=1 -rss_limit_mb=512 -malloc_limit_mb=256 \
    -print_final_stats=1 "${@:3}" "${corpora[@]}" >"$at/log" 2>&1 &&
    [ -z "$(ls "$at/findings")" ]; then
    printf '%-18s %s\n' "$2" "$(awk '/^stat::number_of_executed_units/ {runs = $2} / cov: / {cov = $4}
      /^stat::average_exec_per_sec/ {rate = $2} /^stat::slowest_unit_time_sec/ {slow = $2}
      /^stat::peak_rss_mb/ {rss = $2} END {
        printf "%10d runs %7d/s %6d branches %3d s slowest %4d MB", runs, rate, cov, slow, rss}' "$at/log")"
  else
    printf '%-18s FAILED\n' "$2"
    grep -aE 'ERROR|SUMMARY|what\(\)|runtime error|Test unit written' "$at/log" | head -n 8
    exit 1
  fi
}
export -f fuzz_one
if [ $# -gt 0 ]; then printf '%s\n' "$@"; else echo "$known"; fi |
  xargs -P "$(nproc)" -I{} bash -c 'fuzz_one "$@"' _ "$folder" {} "${limit[@]}" || exit 1
