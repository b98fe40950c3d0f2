#!/usr/bin/env bash
# Unpacks another version of Mesa's Vulkan drivers below target/, without touching the system, to test with it.
set -euo pipefail

usage() {
    cat <<'END'
usage: tools/driver.sh [VERSION [check [SCENE...] | queries [SCENE...]]]
  (nothing)  list the versions of Mesa that the system's distribution and its backports offer
  VERSION    unpack it into target/drivers/VERSION, where it is not yet, and print the environment that
             uses its software adapter: eval "$(tools/driver.sh 25)"; "newest" is the newest one
  check      render scenes with the system's driver and with this one: pictures of scenes/fail must be
             equal, byte for byte, others but for rays that went another way by the last bit of a number:
             a mean FLIP of .0001. Without SCENE, six of scenes/fail. Uses target/debug/reflet, or REFLET
  queries    render scenes with this driver by our own traversal and by its ray queries, and compare likewise;
             scenes whose assets are not in REFLET_ASSETS are named and left out
END
}

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
# Package with Mesa's Vulkan drivers.
readonly package=mesa-vulkan-drivers

fail() {
    printf 'driver: %s\n' "$1" >&2
    exit 1
}

# apt with a configuration of its own: the system's distribution and its backports.
apt_folder="$root/target/drivers/.apt"
private() {
    local command="$1"
    shift
    "$command" -q -o "Dir::Etc::SourceList=$apt_folder/sources.list" -o Dir::Etc::SourceParts=/dev/null \
        -o "Dir::State::Lists=$apt_folder/lists" -o "Dir::Cache=$apt_folder/cache" \
        -o APT::Sandbox::User=root "$@"
}

refresh() {
    command -v apt-get >/dev/null || fail "needs apt-get: other versions come from the packages of Debian"
    local codename repository
    codename="$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)"
    repository="$(apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
        awk -v codename="$codename" '$2 == codename && $3 == "main" && !found++ { print $1 }')"
    [ -n "$repository" ] || fail "apt knows no repository of \"$codename\"; run apt-get update"
    mkdir -p "$apt_folder/lists/partial" "$apt_folder/cache/archives/partial"
    local keyring=/usr/share/keyrings/debian-archive-keyring.gpg option=""
    [ ! -e "$keyring" ] || option="[signed-by=$keyring] "
    local suite
    for suite in "$codename" "$codename-backports"; do
        echo "deb $option$repository $suite main"
    done >"$apt_folder/sources.list"
    private apt-get update >&2 || fail "the lists of packages cannot be fetched"
}

# Lines of "VERSION SUITE", the newest version first.
offered() { private apt-cache madison "$package" | awk '{ split($6, suite, "/"); print $3, suite[1] }'; }

# Unpacks the version that begins with $1 into $2.
unpack() {
    local wanted="$1" folder="$2" version suite
    refresh
    [ "$wanted" != newest ] || wanted=""
    read -r version suite < <(offered | awk -v start="$wanted" 'index($1, start) == 1') ||
        fail "there is no Mesa $wanted; there is: $(offered | cut -d ' ' -f 1 | paste -sd ' ')"
    rm -rf "$folder" "$apt_folder/packages"
    mkdir -p "$apt_folder/packages" "$folder"
    # The package and those that it needs in another version than is installed.
    local needed
    needed="$(private apt-get --simulate --no-install-recommends --target-release "$suite" \
        install --reinstall "$package=$version" |
        sed -nE 's/^Inst ([^ ]+) (\[[^]]*\] )?\(([^ ]+) .*/\1=\3/p' | grep -v -e '-dev=')"
    # shellcheck disable=SC2086 # one argument for each package
    (cd "$apt_folder/packages" && private apt-get download $needed >&2)
    local file library
    for file in "$apt_folder"/packages/*.deb; do
        dpkg -x "$file" "$folder"
    done
    rm -rf "$apt_folder/packages"
    library="$(compgen -G "$folder/usr/lib/*/libvulkan_lvp.so")" || fail "$package $version has no software adapter"
    sed -E "s#\"library_path\": *\"[^\"]*\"#\"library_path\": \"$library\"#" \
        "$folder"/usr/share/vulkan/icd.d/lvp_icd*.json >"$folder/icd.json"
    {
        echo "export LD_LIBRARY_PATH=$(dirname "$library")"
        echo "export VK_DRIVER_FILES=$folder/icd.json"
        echo "export VK_ICD_FILENAMES=$folder/icd.json" # loaders before 1.3.207
    } >"$folder/environment"
    echo "unpacked $package $version" >&2
}

# Renders each scene with both drivers and compares.
check() {
    local folder="$1"
    shift
    local reflet="${REFLET:-$root/target/debug/reflet}" out="$root/target/drivers/pictures" scene name
    [ -x "$reflet" ] || fail "there is no $reflet; run cargo build first"
    mkdir -p "$out"
    cd "$root"
    [ "$#" -gt 0 ] || set -- scenes/fail/{01-off-screen,05-back-faces,13-bumps,15-facing-mirrors,20-cut-outs,24-light-on-surface}.toml
    local render=("$reflet" render --size 96x54 --method hybrid --stats text)
    local different=0
    for scene in "$@"; do
        name="$(basename "$scene" .toml)"
        "${render[@]}" "$scene" -o "$out/$name-system.png" >"$out/system.txt"
        (
            # shellcheck source=/dev/null
            . "$folder/environment"
            "${render[@]}" "$scene" -o "$out/$name.png" >"$out/other.txt"
        )
        if ! cmp "$out/$name-system.png" "$out/$name.png" &&
            ! { [[ "$scene" != *scenes/fail/* ]] &&
                "$reflet" compare --max-flip .0001 "$out/$name.png" "$out/$name-system.png"; }; then
            different=$((different + 1))
        fi
    done
    head -qn 1 "$out/system.txt" "$out/other.txt"
    [ "$(sed -n 1p "$out/system.txt")" != "$(sed -n 1p "$out/other.txt")" ] ||
        fail "both are the same driver"
    [ "$different" = 0 ] || fail "$different of $# pictures differ; they are in $out"
    echo "$# pictures agree"
}

# Renders each scene by our traversal and by ray queries.
queries() {
    local folder="$1"
    shift
    local reflet="${REFLET:-$root/target/debug/reflet}" out="$root/target/drivers/queries" scene name trace said
    [ -x "$reflet" ] || fail "there is no $reflet; run cargo build first"
    mkdir -p "$out"
    cd "$root"
    # shellcheck source=/dev/null
    . "$folder/environment"
    [ "$#" -gt 0 ] || set -- scenes/fail/{01-off-screen,05-back-faces,13-bumps,15-facing-mirrors,20-cut-outs,24-light-on-surface}.toml
    local different=0 compared=0
    for scene in "$@"; do
        name="$(basename "$scene" .toml)"
        for trace in software query; do
            said="$("$reflet" render --size 96x54 --method rt --set "reflection.trace=\"$trace\"" "$scene" \
                -o "$out/$name-$trace.png" 2>&1)" || {
                [[ "$said" == *"error[file-not-found]"* ]] || fail "$scene: $said"
                echo "NOT COMPARED: $scene, whose assets are in no folder of REFLET_ASSETS"
                continue 2
            }
            [ -z "$said" ] || printf '%s\n' "$said"
        done
        compared=$((compared + 1))
        if ! cmp "$out/$name-software.png" "$out/$name-query.png" &&
            ! { [[ "$scene" != *scenes/fail/* ]] &&
                "$reflet" compare --max-flip .001 "$out/$name-query.png" "$out/$name-software.png"; }; then
            different=$((different + 1))
        fi
    done
    [ "$different" = 0 ] || fail "$different of $compared pictures differ; they are in $out"
    [ "$compared" -gt 0 ] || fail "no scene has its assets here"
    echo "$compared pictures agree by ray queries"
}

version="${1:-}"
case "$version" in
    -h | --help)
        usage
        exit 0
        ;;
    '')
        refresh
        offered
        exit 0
        ;;
    *[!A-Za-z0-9.~+:-]* | -*)
        usage >&2
        exit 2
        ;;
esac
folder="$root/target/drivers/$version"
[ -e "$folder/environment" ] || unpack "$version" "$folder"
shift
case "${1:-}" in
    '') cat "$folder/environment" ;;
    check)
        shift
        check "$folder" "$@"
        ;;
    queries)
        shift
        queries "$folder" "$@"
        ;;
    *)
        usage >&2
        exit 2
        ;;
esac
