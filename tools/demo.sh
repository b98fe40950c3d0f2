#!/usr/bin/env bash
# From nothing to a picture: setup, build, and the built-in scene as atrium.png in this folder's
# root. Needs no GPU and no display.
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
"$root/tools/setup.sh"
export PATH="$HOME/.cargo/bin:$PATH"
cd "$root"

printf '\n== Building ==\n'
# Without the window, which half of the packages are for; the preview is a page.
cargo build --locked --no-default-features --features serve

printf '\n== Rendering the built-in scene ==\n'
binary="${CARGO_TARGET_DIR:-$root/target}/debug/reflet"
"$binary" render --output "$root/atrium.png" --stats text
