#!/usr/bin/env bash
# Trial additions of docs/extending.md: the patches of tests/extending, refreshed or built.
set -euo pipefail

usage() {
    echo "usage: tools/extending.sh --refresh | --build [NAME...]"
    echo "  --refresh  write the patches anew for the code as it is, and the tables of docs/extending.md"
    echo "  --build    build the program and check its shaders with each patch, or with those named"
}

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
cd "$root"

mode="${1:-}"
case "$mode" in
    --refresh | --build) shift ;;
    -h | --help)
        usage
        exit 0
        ;;
    *)
        usage >&2
        exit 2
        ;;
esac

patches=()
if [ $# -gt 0 ]; then
    for name in "$@"; do patches+=("$root/tests/extending/$name.patch"); done
else
    patches=("$root"/tests/extending/*.patch)
fi

# A copy of the files as they are, with what is not committed, in a repository of its own.
# Its place is always the same, so that the builds of one run serve the next.
readonly copy="$root/target/extending"
trap 'rm -rf "$copy"' EXIT
rm -rf "$copy"
mkdir -p "$copy"
git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    xargs -0 cp --parents --no-dereference --preserve=timestamps --target-directory "$copy"
git -C "$copy" init --quiet
git -C "$copy" add --all
git -C "$copy" -c user.name=reflet -c user.email=reflet@localhost commit --quiet --message "Copy"

restore() {
    git -C "$copy" reset --quiet --hard
    git -C "$copy" clean --quiet --force -d
}

failed=no
for patch in "${patches[@]}"; do
    name="$(basename "$patch" .patch)"
    if [ "$mode" = --build ]; then
        echo "== $name"
        git -C "$copy" apply "$patch"
        # The same folder of builds for all, so that dependencies are built once.
        (cd "$copy" && CARGO_TARGET_DIR="$root/target" cargo test --locked --test pictures -- shaders::) || failed=yes
    elif patch --quiet --directory "$copy" --strip 1 --fuzz 3 --no-backup-if-mismatch <"$patch" >/dev/null; then
        (cd "$copy" && cargo fmt --all)
        git -C "$copy" add --all
        git -C "$copy" diff --cached --no-color --full-index >"$patch"
    else
        echo "$name: its hunks no longer fit. Make the addition by hand, then: git diff >tests/extending/$name.patch" >&2
        failed=yes
    fi
    restore
done
if [ "$mode" = --refresh ]; then
    UPDATE_DOCS=1 cargo test --locked --test layers -- trial_additions || failed=yes
fi
[ "$failed" = no ]
