#!/usr/bin/env bash
# Errors of an experiment by GNU parallel, here four at a time, then its times, when nothing else runs, then both in one.
# Start it as: experiments/cluster/parallel.sh experiments/rivals.toml rivals
set -euo pipefail

# GNU parallel tells each job its number, not how many there are.
seq 8 | parallel -j 4 -N0 halfshade --threads 2 run "$1" --shard auto/8 --resume
halfshade run "$1" --times --resume
halfshade merge "out/$2-parts/"*
