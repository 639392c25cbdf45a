#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A study's night, for cron or a systemd timer: does what changed, rechecks a few steps that did not, and keeps
# the output of each night beside the results. Exit codes are those of plumbline study: 3 is a regression.
# Usage: scripts/nightly.sh STUDY.yaml FOLDER [OPTIONS OF plumbline study]
# PLUMBLINE names the program (default: plumbline in the PATH), PLUMBLINE_MAIL who is told of a night that did
# not end well (by mail(1)).
set -uo pipefail
if [ $# -lt 2 ]; then
  echo "usage: $0 STUDY.yaml FOLDER [OPTIONS]" >&2
  exit 2
fi
study=$1 folder=${2%/}
shift 2
mkdir -p "$folder.logs" || exit 2
log=$folder.logs/$(date -u +%Y-%m-%dT%H-%M-%SZ).txt
recheck=(--recheck 5)
case " $* " in *" --recheck"[\ =]*) recheck=() ;; esac
"${PLUMBLINE:-plumbline}" study "$study" --out "$folder" ${recheck[@]+"${recheck[@]}"} "$@" >"$log" 2>&1
code=$?
cat "$log"
# A year of them is enough.
find "$folder.logs" -name '*.txt' -mtime +365 -delete
if [ "$code" -ne 0 ] && [ -n "${PLUMBLINE_MAIL:-}" ]; then
  case $code in
    1) subject="failed" ;;
    2) subject="could not begin" ;;
    3) subject="REGRESSION" ;;
    *) subject="ended with $code" ;;
  esac
  mail -s "plumbline study $(basename "$study"): $subject" "$PLUMBLINE_MAIL" <"$log"
fi
exit "$code"
