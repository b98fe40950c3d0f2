#!/usr/bin/env bash
# Renders ten stages of a USD corpus into one picture, the animated ones at three times.
set -euo pipefail

if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    echo "usage: tools/usd_sheet.sh CORPUS [OUT.png]   (default docs/images/usd.png)" >&2
    exit 2
fi
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
corpus="$(cd "$1" && pwd)"
out="$(realpath "${2:-$root/docs/images/usd.png}")"
readonly root corpus out
cd "$root"
cargo build --locked
binary="${CARGO_TARGET_DIR:-$root/target}/debug/reflet"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cells=()

# still CAPTION STAGE [ARGUMENT…]
still() {
    local picture="$folder/${#cells[@]}.png"
    render "$2" -o "$picture" "${@:3}"
    cells+=("$1=$picture")
}

# film CAPTION STAGE FRAME FRAME FRAME
film() {
    local number="${#cells[@]}" frame
    render "$2" -o "$folder/$number.#.png" --frames "$3,$4,$5"
    for frame in "$3" "$4" "$5"; do
        cells+=("$1, frame $frame=$folder/$number.$frame.png")
    done
}

render() {
    "$binary" render "$corpus/$1" "${@:2}" --assets "$corpus" --size 320x240 --samples 8 \
        2> "$folder/said" || {
        cat "$folder/said" >&2
        exit 1
    }
}

cars=usd-wg-assets/full_assets/Vehicles/USD_Mini_Car_Kit/assets/vehicles
tests=usd-wg-assets/test_assets
imaging=PixarAnimationStudios-OpenUSD/pxr/usdImaging/usdImagingGL/testenv
still "formula car: subsets, references" "$cars/formula/asset/formulaFullAsset.usda"
still "tractor: layers, materials" "$cars/tractor/asset/tractorFullAsset.usda"
still "ambulance: shared wheels" "$cars/ambulance/asset/ambulanceFullAsset.usda"
still "UtahTeapot: a large mesh" usd-wg-assets/intent-vfx/assets/teapot/geo/UtahTeapot.usd
still "chess pawn" usd-wg-assets/full_assets/OpenChessSet/assets/Pawn/Pawn_geom.usd
still "TextureTransformTest" "$tests/TextureTransformTest/TextureTransformTest.usd"
still "pi_basic: point instancer" "$imaging/testUsdImagingGLPointInstancer/pi_basic.usda"
film "AnimatedCube" "$tests/USDZ/AnimatedCube/AnimatedCube.usdz" 0 10 20
film "BoxAnimated" "$tests/USDZ/BoxAnimated/BoxAnimated.usdz" 0 30 60
film "pi_pi_time: moving instancers" "$imaging/testUsdImagingGLPointInstancer/pi_pi_time.usda" 0 1 2
.venv/bin/python tools/sheet.py "$out" --columns 4 --width 320 "${cells[@]}"
echo "wrote $out"
