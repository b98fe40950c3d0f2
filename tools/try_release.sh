#!/usr/bin/env bash
# Installs the artifacts of a release, each in an empty root of Debian 11, 12 and 13, and renders there. Needs root and
# debootstrap.
#
#   tools/try_release.sh FOLDER [SUITE…]      FOLDER is what tools/release.sh wrote
set -euo pipefail

folder="$(realpath "$1")"
shift
suites=("$@")
[ $# -gt 0 ] || suites=(bullseye bookworm trixie)
work="$(mktemp -d)"
readonly folder work
trap 'umount -q "${root:-}/proc" || true; rm -rf "$work"' EXIT

fail() {
    printf 'release: %s\n' "$1" >&2
    exit 1
}
archive="$(basename "$folder"/reflet-*-linux.tar.xz)"
scene=share/doc/reflet/scenes/mirrors.toml
(cd "$folder" && sha256sum --check --quiet SHA256SUMS)
tar -xf "$folder/$archive" -C "$work"
here="$work/${archive%.tar.xz}"
"$here/bin/reflet" render "$here/$scene" -o "$work/here.png" --size 96x54 --samples 4

# Runs a command in the root, as a user without rights; as root with `root` first.
within() {
    local user=nobody
    [ "$1" != root ] || { user=root && shift; }
    chroot "$root" runuser -u "$user" -- env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/home/it LC_ALL=C "$@"
}
# Says how long the command took that made the first picture, which must look as the one of this machine.
picture() {
    local what="$1" began=$SECONDS
    shift
    within "$@" -o /home/it/picture.png --size 96x54 --samples 4 || fail "$suite, $what: does not render"
    "$here/bin/reflet" compare "$root/home/it/picture.png" "$work/here.png" --max-flip 0.01 >/dev/null ||
        fail "$suite, $what: another picture"
    rm "$root/home/it/picture.png"
    printf '%s, %s: a picture after %d s\n' "$suite" "$what" $((SECONDS - began))
}

# Checks the program and the module of the installed wheels.
wheels() {
    picture "$1, program" /home/it/venv/bin/reflet render "$unpacked/$scene"
    within /home/it/venv/bin/python -c "
import reflet
with reflet.open('$unpacked/$scene', size=(96, 54)) as scene:
    assert scene.render().display.shape[:2] == (54, 96)"
    printf '%s, %s: renders to an array\n' "$suite" "$1"
}

for suite in "${suites[@]}"; do
    root="$work/$suite"
    debootstrap --variant=minbase --include=ca-certificates,xz-utils "$suite" "$root" >"$work/log" 2>&1 ||
        fail "$(tail -n 5 "$work/log")"
    mount -t proc proc "$root/proc"
    install -d -m 777 "$root/home/it"
    cp "$folder"/* "$root/home/it"
    [ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
    unpacked="/home/it/${archive%.tar.xz}"

    # Without a driver: exit code 4, and a sentence that says what to install.
    within sh -c "cd /home/it && tar -xf $archive"
    status=0
    within "$unpacked/bin/reflet" render "$unpacked/$scene" -o /home/it/no.png 2>"$work/log" || status=$?
    [ "$status" = 4 ] && grep -q mesa-vulkan-drivers "$work/log" || fail "$suite, no driver: $status, $(cat "$work/log")"

    # The driver that comes along, with its Vulkan loader.
    driver="$(echo "$folder"/reflet_software-*.whl)"
    has_driver=yes
    if within sh -c "dpkg --compare-versions \$(dpkg-query -W -f '\${Version}' libc6) ge $(sed 's/.*manylinux_\([0-9]*\)_\([0-9]*\)_.*/\1.\2/' <<<"$driver")"; then
        within sh -c 'cd /home/it && tar -xf reflet-software-*.tar.xz'
        picture "software driver" "$unpacked/bin/reflet" render "$unpacked/$scene"
        rm -r "$root$unpacked/lib"
    else
        has_driver=no
    fi

    # Wheels, of the program first with the driver's.
    within root sh -c 'apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends python3-venv python3-numpy' \
        >"$work/log" 2>&1 || fail "$(tail -n 20 "$work/log")"
    has_python=no
    if within python3 -c 'import sys, numpy; sys.exit(sys.version_info < (3, 11) or numpy.__version__ < "1.26")'; then
        has_python=yes
        within sh -c 'cd /home/it && python3 -m venv --system-site-packages venv && venv/bin/pip install -q --no-index reflet-*-abi3-*.whl reflet_software-*.whl'
        wheels "wheels of package and driver"
    else
        printf '%s, wheels: NOT CHECKED, its Python is older than 3.11 or its NumPy than 1.26\n' "$suite"
    fi

    within root sh -c "cd /home/it && DEBIAN_FRONTEND=noninteractive apt-get install -y -q ./reflet_*_amd64.deb" \
        >"$work/log" 2>&1 || fail "$(tail -n 20 "$work/log")"
    if [ "$has_driver" = no ]; then
        # Its own Mesa is older than what Reflet needs: the program runs, and says so.
        within reflet check "/usr/$scene"
        status=0
        within reflet render "/usr/$scene" -o /home/it/no.png 2>"$work/log" || status=$?
        [ "$status" = 4 ] || fail "$suite, old driver: $status, $(cat "$work/log")"
        printf '%s, Debian package: checks scenes; renders on GPUs alone\n' "$suite"
        umount "$root/proc"
        continue
    fi
    picture "Debian package" reflet render "/usr/$scene"
    within sh -c 'test -s /usr/share/man/man1/reflet-render.1.gz || grep -q man /etc/dpkg/dpkg.cfg.d/*'
    within root apt-get remove -y -q reflet >/dev/null
    picture archive "$unpacked/bin/reflet" render "$unpacked/$scene"

    if [ "$has_python" = yes ]; then
        within /home/it/venv/bin/pip uninstall -q -y reflet-software
        wheels wheel
    fi
    umount "$root/proc"
    rm -rf "$root"
done
