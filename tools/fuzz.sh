#!/usr/bin/env bash
# Feeds broken files to the readers of glTF, panoramas and scene text, each 10 minutes unless --seconds says otherwise.
# A panic, more than 1.5 GB, or more than 5 s end the run (glTF 20 s, as decoders run hardly optimized; a scene 30 s, as it
# may place a thousand); the input is kept in fuzz/artifacts.
set -euo pipefail

seconds=600
targets=(gltf panorama scene)
while [ $# -gt 0 ]; do
    case "$1" in
        --seconds)
            seconds="${2:?--seconds N}"
            shift 2
            ;;
        gltf | panorama | scene)
            targets=("$1")
            shift
            ;;
        *)
            echo "usage: tools/fuzz.sh [--seconds N] [gltf|panorama|scene]" >&2
            exit 2
            ;;
    esac
done
readonly seconds targets

cd "$(dirname "${BASH_SOURCE[0]}")/.."

RUSTC_WRAPPER="$PWD/fuzz/rustc.sh" cargo build --locked --manifest-path fuzz/Cargo.toml

# Seeds: valid inputs, and broken ones from the tests.
for target in "${targets[@]}"; do
    seeds="fuzz/corpus/$target"
    longest_s=5
    mkdir -p "$seeds" fuzz/artifacts
    case "$target" in
        gltf)
            longest_s=20
            folders=(scripts tests/gltf)
            [ -d "${REFLET_CORPUS:-../shared/corpus}" ] && folders+=("${REFLET_CORPUS:-../shared/corpus}")
            python3 tools/fuzz_seeds.py "$seeds" "${folders[@]}"
            ;;
        panorama)
            python3 tools/fuzz_seeds.py "$seeds" --panoramas
            ;;
        scene)
            longest_s=30
            python3 tools/fuzz_seeds.py "$seeds" --scenes
            find scenes scripts tests/bad_scenes -name '*.toml' | while read -r file; do
                cp "$file" "$seeds/$(sha256sum "$file" | cut -c1-16)"
            done
            ;;
    esac
    echo "== $target: $seconds s =="
    "fuzz/target/debug/$target" "$seeds" -max_total_time="$seconds" -timeout="$longest_s" \
        -rss_limit_mb=1500 -malloc_limit_mb=1500 -artifact_prefix="fuzz/artifacts/$target-" \
        -print_final_stats=1 -verbosity=0
done
