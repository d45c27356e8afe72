#!/usr/bin/env bash
# Errors of an experiment as a Slurm array, then its times alone on a machine, then both in one.
# Submit it as: sbatch experiments/cluster/slurm.sh experiments/rivals.toml
#SBATCH --job-name=halfshade
#SBATCH --array=1-8
#SBATCH --cpus-per-task=8
#SBATCH --time=02:00:00
set -euo pipefail

# Slurm tells each task its number and how many there are.
halfshade --threads "${SLURM_CPUS_PER_TASK:-8}" run "$1" --shard auto --resume

# When the array has ended:
#   sbatch --exclusive --wrap "halfshade run experiments/rivals.toml --times --resume"
#   halfshade merge out/rivals-parts/*
