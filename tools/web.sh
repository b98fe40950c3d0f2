#!/bin/sh
# Builds the page that runs Reflet by itself (docs/web.md): a folder of files, target/web/page or the one that is named.
# Exits with 3 where a tool is missing, and names it.
set -eu
cd "$(dirname "$0")/.."
folder=${1:-target/web/page}

lacks() {
    echo "tools/web.sh needs $1: $2" >&2
    exit 3
}

target=wasm32-unknown-unknown
std=
if ! [ -d "$(rustc --print target-libdir --target $target 2>/dev/null)" ]; then
    # Debian's toolchain for browsers has the library as source.
    [ -d /usr/lib/rustlib/src/rust/library ] && /usr/bin/rustc --version >/dev/null 2>&1 ||
        lacks "Rust for WebAssembly" "rustup target add $target, or apt-get install rustc-web cargo-web rust-web-src lld-22"
    PATH=/usr/bin:$PATH
    std=-Zbuild-std=std,panic_abort
    export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
fi
version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' Cargo.lock)
bindgen=$(command -v wasm-bindgen || echo target/web/tools/bin/wasm-bindgen)
[ "$("$bindgen" --version 2>/dev/null)" = "wasm-bindgen $version" ] ||
    lacks "wasm-bindgen $version" "cargo install wasm-bindgen-cli --version =$version --root target/web/tools"

# Scripts and shapes nest deeper than the 1 MiB that the linker gives; names of folders of this machine are left out.
export RUSTFLAGS="-Clink-arg=-zstack-size=8388608 --remap-path-prefix=$PWD= --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}="
unset RUSTC_WORKSPACE_WRAPPER
# Tables of measurements name it.
REFLET_COMMIT=$(git describe --always --abbrev=12 --dirty --exclude='*' 2>/dev/null || echo unknown)
export REFLET_COMMIT
cargo build --locked $std --target $target --target-dir target/web -p reflet-web --profile web

rm -rf "$folder"
mkdir -p "$folder/scenes"
"$bindgen" --target web --no-typescript --remove-name-section --remove-producers-section --out-dir "$folder" target/web/$target/web/reflet_web.wasm
cp src/web/page/* src/write_back/page/* "$folder"
cp scenes/*.toml scenes/*.rhai scenes/*.png "$folder/scenes"
# Files of a new project, as `reflet new` writes them.
cp -R src/app/new "$folder"
sed 's/NAME/"new"/' src/app/new/reflet.toml >"$folder/new/reflet.toml"
for listed in scenes new; do
    (cd "$folder/$listed" && find . -type f | sort | sed 's,^\./\(.*\),"\1",' | paste -sd, | sed 's/.*/[&]/') >"$folder/names"
    mv "$folder/names" "$folder/$listed/names.json"
done
# Scenes of the bench without models, which are no examples.
awk -v RS= '!/\nmodels = true/' docs/data/views.toml | sed -n 's/^scene = "\(.*\)"$/\1/p' | tar -cf - -T - | tar -xf - -C "$folder"

packed=$(find "$folder" -type f -exec gzip -9c {} + | wc -c)
echo "$folder: $packed bytes as gzip sends them; serve it by https or from localhost"
