#!/usr/bin/env bash
# Makes the pictures of the READMEs: built-in scenes, each by the technique that suits it, and path tracing beside that
# technique at equal time. SECONDS_EACH sets the seconds of a clean picture, SECONDS_STRIP those of the comparison.
# Needs cargo alone.
set -euo pipefail
cd "$(dirname "$0")/.."
clean=${SECONDS_EACH:-45}
strip=${SECONDS_STRIP:-5}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sheet() { cargo run --release --quiet --package xtask --example contact_sheet -- "$@"; }

# Scene and technique.
scenes=(glass-ball:sppm studio:bidir veach-mis:path ring:sppm pool:sppm hidden-lights:bidir cornell:path glossy-caustic:sppm)
pictures=()
for pair in "${scenes[@]}"; do
    scene=${pair%%:*} technique=${pair##*:}
    cargo xtask render "$scene" --technique "$technique" --size 290 --seconds "$clean" --out "$work/$scene.exr"
    pictures+=("$work/$scene.png=$scene, $technique")
done
sheet docs/scenes.png 4 290 "${pictures[@]}"
sheet crates/path/picture.png 1 290 "$work/cornell.png"

# At equal time, at the size of the stored references, which the errors are against.
pairs=()
for pair in ring:sppm hidden-lights:bidir; do
    scene=${pair%%:*}
    for technique in path "${pair##*:}"; do
        image=$work/$scene-$technique
        cargo xtask render "$scene" --technique "$technique" --size 128 --seconds "$strip" --out "$image.exr"
        error=$(cargo xtask compare "$image.exr" "reference/$scene.exr" | awk '$1 == "relmse" { printf "%.2g", $2 }')
        pairs+=("$image.png=$technique, $strip s, relMSE $error")
    done
done
sheet docs/equal-time.png 4 300 "${pairs[@]}"
