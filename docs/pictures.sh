#!/usr/bin/env bash
# Makes the pictures of the READMEs: 45 seconds of rendering for each of eight built-in scenes.
# SECONDS_EACH sets another time. Needs cargo alone.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${SECONDS_EACH:-45}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pictures=()
for scene in cornell veach-mis furnace:material=rough-conductor glass-caustic ring ajar-door many-lights sky; do
    name=${scene%%:*}
    cargo xtask render "$scene" --size 256 --seconds "$seconds" --out "$work/$name.exr"
    pictures+=("$work/$name.png")
done
cargo run --release --quiet --package xtask --example contact_sheet -- docs/scenes.png 4 152 "${pictures[@]}"
cargo run --release --quiet --package xtask --example contact_sheet -- crates/path/picture.png 1 256 "$work/cornell.png"
