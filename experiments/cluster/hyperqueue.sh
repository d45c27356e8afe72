#!/usr/bin/env bash
# Errors of an experiment as a HyperQueue task array, then its times alone on a machine, then both in one.
# Start it as: experiments/cluster/hyperqueue.sh experiments/rivals.toml rivals
set -euo pipefail

# HyperQueue tells each task its number, not how many there are.
hq submit --wait --array 1-8 --cpus 8 -- halfshade --threads 8 run "$1" --shard auto/8 --resume
# All processors of a node at once: nothing else runs there.
hq submit --wait --cpus all -- halfshade run "$1" --times --resume
halfshade merge "out/$2-parts/"*
