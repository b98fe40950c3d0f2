#!/usr/bin/env bash
# Renders the pictures of docs/gallery.md anew, by the commands that stand there.
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
cd "$root"
# The denoiser is checked before minutes of rendering.
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
export PATH="${CARGO_TARGET_DIR:-$root/target}/debug:$PATH"

# The commands run in a folder of their own that looks like the repository and holds the README's scene.
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
ln -s "$root"/{.venv,docs,scenes,scripts,tools} "$folder"
mkdir "$folder/frames"
# Lines of the code blocks in language $2 of the page $1; $3 stops after the first block.
blocks() { awk -v fence="\`\`\`$2" -v once="${3:-}" '$0 == fence { f = 1; next } /^```/ { if (f && once) exit; f = 0 } f' "$1"; }
blocks README.md toml once >"$folder/my.toml"
blocks docs/gallery.md sh >"$folder/gallery.sh"
cd "$folder"
bash -euo pipefail gallery.sh
