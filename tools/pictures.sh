#!/usr/bin/env bash
# Renders the README's pictures from the built-in scenes into docs/images.
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
cd "$root"
# The denoiser is checked before minutes of rendering: it removes the grain of the three scenes below.
if [ -z "${REFLET_OIDN:-}" ]; then
    for folder in "$root"/.venv/lib/*/site-packages/pyoidn/oidn/lib; do
        [ ! -d "$folder" ] || export REFLET_OIDN="$folder"
    done
fi
if ! compgen -G "${REFLET_OIDN:-/nowhere}/libOpenImageDenoise*" >/dev/null; then
    echo "pictures: REFLET_OIDN must name the folder of Open Image Denoise; tools/setup.sh installs it" >&2
    exit 1
fi
cargo build --locked
binary="${CARGO_TARGET_DIR:-$root/target}/debug/reflet"
images="$root/docs/images"
mkdir -p "$images"

"$binary" render --samples 16 --output "$images/atrium.png"
for method in ssr hybrid rt; do
    "$binary" render --samples 4 --size 640x360 --method "$method" --output "$images/atrium-$method.png"
done
"$binary" render --size 640x360 --aov source,cause --output "$images/atrium-one.png"
mv "$images/atrium-one.source.png" "$images/atrium-source.png"
mv "$images/atrium-one.cause.png" "$images/atrium-cause.png"
rm "$images/atrium-one.png"
"$binary" render "$root/scenes/studio.toml" --samples 16 --size 640x360 --denoise --output "$images/studio.png"
"$binary" render "$root/scenes/interior.toml" --samples 16 --size 640x360 --denoise --output "$images/interior.png"
"$binary" render "$root/scenes/street.toml" --samples 16 --size 960x540 --denoise --output "$images/street.png"

# The films at their start and at the later frame that differs most.
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cells=()
for film in walk:60 lamp:60 gears:30 path:60 bounce:25 polish:60; do
    later="${film#*:}" film="${film%:*}"
    "$binary" render "$root/scripts/$film.toml" --samples 4 --size 320x180 --frames "0,$later" \
        --output "$folder/$film.#.png"
    cells+=("$film.toml, frame 0=$folder/$film.0.png" "frame $later=$folder/$film.$later.png")
done
.venv/bin/python tools/sheet.py "$images/films.png" --columns 4 --width 320 "${cells[@]}"
