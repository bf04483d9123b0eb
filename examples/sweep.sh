#!/bin/sh
# A sweep in shards without a scheduler: here two processes, on several machines one each, with the
# results in a folder that all of them see. Killed at any time, the same command goes on.
# sh examples/sweep.sh SWEEP.toml DIR
set -eu
sweep="$1"
out="$2"
shards=2

processes=""
for k in $(seq "$shards"); do
    arclen sweep "$sweep" --quiet --shard "$k/$shards" --jobs 1 --out "$out/shard-$k" &
    processes="$processes $!"
done
for process in $processes; do
    # 3 is a shard in which some case stopped early or failed; merge says which
    wait "$process" || [ "$?" -eq 3 ]
done
arclen merge "$out"/shard-* --out "$out"
