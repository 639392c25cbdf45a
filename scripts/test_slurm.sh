#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A study on a real Slurm of one node that this script starts, beside the same study on the local engine: the
# stores must hold the same values, though one task is killed and the node is drained on the way.
#   scripts/install_dependencies.sh slurm
# Needs root (slurmd's), and no Slurm that listens on its two ports. Ends what it starts. KEEP=1 leaves its folder.
# Usage: scripts/test_slurm.sh [PLUMBLINE]
set -euo pipefail
self=$(realpath "$0")
[ "$(id -u)" = 0 ] || exec sudo "KEEP=${KEEP:-}" "$self" "$@"
plumbline=$(realpath "${1:-$(dirname "$self")/../build/evaluate/plumbline}")
cd "$(dirname "$self")/.."
work=$(mktemp -d)
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  [ -n "${KEEP:-}" ] && echo "kept: $work" || rm -rf "$work"
}
trap finish EXIT

# Munge, which signs what Slurm's daemons say to each other.
mkdir -p "$work"/{munge,state,spool}
chmod 755 "$work"
chmod 700 "$work/munge"
head -c 1024 /dev/urandom >"$work/munge/key"
chmod 600 "$work/munge/key"
munged --foreground --force --socket="$work/munge.socket" --key-file="$work/munge/key" \
  --log-file="$work/munge/log" --pid-file="$work/munge/pid" --seed-file="$work/munge/seed" &
pids+=($!)

host=$(hostname -s)
cores=$(nproc)
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CryptoType=crypto/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000,requeue_delay=1
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MaxArraySize=20
ReturnToService=2
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cores State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
sleep 1
slurmctld -D -f "$SLURM_CONF" >"$work/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -f "$SLURM_CONF" >"$work/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 60); do
  [ "$(sinfo -h -o %t 2>/dev/null)" = idle ] && break
  sleep 0.5
done
if [ "$(sinfo -h -o %t)" != idle ]; then
  tail -n 20 "$work"/slurm*.log "$work"/slurm*.out >&2
  echo "Slurm did not start" >&2
  exit 1
fi

seed=0
for name in p1_free p1_guided p2_free p2_guided eval1 eval2; do
  seed=$((seed + 1))
  "$plumbline" simulate --out "$work/data/$name" --duration 8 --seed $seed >/dev/null
done
cat >"$work/data/STUDY.yaml" <<STUDY
study: cluster
methods: [free, guided]
sessions:
  - {name: p1_free, participant: p1, method: free, period: 1, path: p1_free}
  - {name: p1_guided, participant: p1, method: guided, period: 2, path: p1_guided}
  - {name: p2_free, participant: p2, method: free, period: 2, path: p2_free}
  - {name: p2_guided, participant: p2, method: guided, period: 1, path: p2_guided}
held_out: [{name: eval1, path: eval1}, {name: eval2, path: eval2}]
perturbations: {offsets_ms: [100, 10, 1]}
STUDY

"$plumbline" study "$work/data/STUDY.yaml" --out "$work/local" >/dev/null 2>&1
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/cluster" --engine slurm --slurm-pack 1 \
  >"$work/cluster.txt" 2>&1 &
night=$!

# A task is killed: its steps leave no marker.
for _ in $(seq 200); do
  victim=$(pgrep -n -f "study run-pack $work/cluster" || true)
  [ -n "$victim" ] && kill -9 "$victim" && break
  sleep 0.05
done
[ -n "$victim" ] || { echo "no task to kill was seen" >&2; exit 1; }
# The node is drained: what runs ends, nothing starts, until it is back.
scontrol update nodename="$host" state=drain reason=test
sleep 3
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/cluster" --engine slurm >"$work/second.txt" 2>&1 &&
  { echo "a second night began" >&2; exit 1; }
grep -q "another night is running here" "$work/second.txt" || { cat "$work/second.txt" >&2; exit 1; }
scontrol update nodename="$host" state=resume

code=0
wait $night || code=$?
cat "$work/cluster.txt"
[ $code = 0 ] || { echo "the night ended with $code" >&2; exit 1; }
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/cluster" --engine slurm >"$work/again.txt" 2>&1
grep -q "Night 2" "$work/again.txt"
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/local" >/dev/null 2>&1

# The third night has steps to do again, one task at a time, and finds another value from the same inputs:
# exit code 3, as on the local engine.
for folder in local cluster; do
  rm "$work/$folder"/sessions/*/perturb/step.json
  python3 - "$work/$folder/sessions/p1_free/evaluate_eval1/step.json" <<'PYTHON'
import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    step = json.load(file)
step["part"]["held_out"][0]["rmse_px"] *= 1.001
with open(sys.argv[1], "w", encoding="utf-8") as file:
    json.dump(step, file)
PYTHON
done
code=0
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/local" >/dev/null 2>&1 || code=$?
[ $code = 3 ] || { echo "the local third night ended with $code" >&2; exit 1; }
"$plumbline" study "$work/data/STUDY.yaml" --out "$work/cluster" --engine slurm --slurm-pack 1 \
  --slurm-throttle 1 >"$work/third.txt" 2>&1 &
night=$!
throttled=no
while kill -0 $night 2>/dev/null; do
  scontrol show job 2>/dev/null | grep -q "ArrayTaskThrottle=1" && throttled=yes
  running=$(squeue -h -t R 2>/dev/null | wc -l)
  [ "$running" -le 1 ] || { echo "$running tasks at once under a throttle of 1" >&2; exit 1; }
  sleep 0.1
done
code=0
wait $night || code=$?
[ $code = 3 ] || { cat "$work/third.txt" >&2; echo "the third night ended with $code, not 3" >&2; exit 1; }
[ $throttled = yes ] || { echo "no array was throttled" >&2; exit 1; }
grep -q "REGRESSION" "$work/third.txt"

python3 - "$work" <<'PYTHON'
import json
import sqlite3
import sys

work = sys.argv[1]
TIMES = {"seconds", "calibration_s", "date", "provenance", "cpu_s", "peak_mb"}


def values(folder):
    db = sqlite3.connect(f"{work}/{folder}/study.sqlite")
    figures = db.execute("SELECT session, name, unit, inputs_key, version, hex(CAST(value AS BLOB)), first_night "
                         "FROM figures WHERE name != 'calibration_s' ORDER BY 1, 2").fetchall()
    steps = db.execute("SELECT name, key, status, message FROM steps ORDER BY 1").fetchall()
    return figures, steps


def timeless(value):
    """A document without what two runs of it never share."""
    if isinstance(value, dict):
        return {k: timeless(v) for k, v in value.items() if k not in TIMES}
    return [timeless(v) for v in value] if isinstance(value, list) else value


def differences(a, b, path=""):
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        return [d for k in a for d in differences(a[k], b[k], f"{path}/{k}")]
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return [d for i, (x, y) in enumerate(zip(a, b)) for d in differences(x, y, f"{path}/{i}")]
    return [] if a == b else [f"{path}: {a} and {b}"]


def summary(folder):
    with open(f"{work}/{folder}/summary.json", encoding="utf-8") as file:
        return timeless(json.loads(file.read().replace(f"{work}/{folder}", "NIGHT")))


local, cluster = values("local"), values("cluster")
assert local == cluster, "the stores differ"
assert len(local[0]) > 100 and all(step[2] == "done" for step in local[1])
assert len(summary("local")["alarms"]) > 0
differ = differences(summary("local"), summary("cluster"))
assert not differ, "the summaries differ: " + "; ".join(differ)
print(f"{len(local[0])} figures and {len(local[1])} steps are equal")
PYTHON
