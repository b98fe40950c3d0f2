#!/usr/bin/env bash
# All checks of continuous integration; with --full, also the slow ones.
set -euo pipefail

usage() {
    echo "usage: tools/check.sh [--full]"
    echo "  --full  also run the tests that take minutes"
}

full=no
for argument in "$@"; do
    case "$argument" in
        --full) full=yes ;;
        -h | --help)
            usage
            exit 0
            ;;
        *)
            usage >&2
            exit 2
            ;;
    esac
done
readonly full
# Tests that take some of their cases daily take all.
[ "$full" = no ] || export REFLET_LONG=1

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root

# Announces a section, and says how many seconds the one before took.
section=""
heading() {
    if [ -n "$section" ]; then
        printf -- '-- %s: %d s\n' "$section" "$((SECONDS - began))"
    fi
    section="$1" began="$SECONDS"
    printf '\n== %s ==\n' "$section"
}

heading "Setup"
"$root/tools/setup.sh" --build
export PATH="$HOME/.cargo/bin:$PATH"
cd "$root"
mkdir -p target
# setup.sh has installed a software adapter: without one, tests fail here instead of skipping.
export REFLET_REQUIRE_GPU=1
# The software adapter keeps compiled shaders here, whatever the user's settings and home are.
export MESA_SHADER_CACHE_DIR="$root/target/shader-cache" MESA_SHADER_CACHE_MAX_SIZE=1G
export MESA_SHADER_CACHE_DISABLE=false
if [ "$full" = no ]; then
    # It compiles without optimization and to narrower vectors, which takes less time, to the same pixels; --full tests
    # the code of its defaults. Its cache knows nothing of the width, and code of another one crashes.
    export GALLIVM_PERF=nopt LP_NATIVE_VECTOR_WIDTH=128
    MESA_SHADER_CACHE_DIR+="-128"
fi
mkdir -p "$MESA_SHADER_CACHE_DIR"
# Incremental compilation and many parts of a crate cost a first build time, and serve only machines that build again.
[ -d target/debug/incremental ] || export CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_CODEGEN_UNITS=8

heading "Format"
cargo fmt --all -- --check

heading "Setup, and Python without the program, beside lints and build"
# Clippy is the compiler of this package, with the arguments of `cargo clippy -- -D warnings`: one build is linted
# and tested.
clippy_driver="$(rustc --print sysroot)/bin/clippy-driver"
linted() {
    RUSTC_WORKSPACE_WRAPPER="$clippy_driver" CLIPPY_ARGS="-D__CLIPPY_HACKERY__warnings" cargo "$@"
}
linted test --locked --workspace --no-run >target/build.log 2>&1 &
readonly build="$!"
trap 'jobs -p | xargs -r kill' EXIT # a check that fails before leaves no compiler behind
# The packages compile one after the other for a third of the build, and leave a processor to this.
"$root/tools/setup.sh"
pytest=(.venv/bin/python -m pytest -q -rs -n auto --maxprocesses 8 --dist worksteal)
if [ "$full" = yes ]; then
    pytest+=(--full)
fi
if [ -f tools/pyproject.toml ]; then
    .venv/bin/ruff check --config tools/pyproject.toml tools tests/tools src/python
    nice -n 5 .venv/bin/mypy --config-file tools/pyproject.toml tools
    nice -n 5 .venv/bin/mypy --strict --python-version 3.11 src/python/reflet
    nice -n 5 "${pytest[@]}" -m "not program" tests/tools
fi

heading "Lints and build"
wait "$build" && failed=no || failed=yes
cat target/build.log
[ "$failed" = no ]

heading "Dependencies of the crates"
# A crate and what it must do without, directly and by what it depends on.
while read -r crate without; do
    tree="$(cargo tree --locked --package "$crate" --edges normal)"
    if grep -E "($without) v" <<<"$tree"; then
        echo "these must not be dependencies of $crate" >&2
        exit 1
    fi
done <<'CRATES'
reflet-render egui|winit|clap|plotters
reflet-metric wgpu|clap
reflet-preview reflet-bench|reflet-output|clap|plotters
reflet-python reflet-bench|reflet-preview|egui|winit|clap|plotters
CRATES

heading "Tests, beside the command line without preview"
# The command line without preview, the tests of Python that run the program, or tests of Rust chosen by arguments.
run_part() {
    if [ "$1" = without-preview ]; then
        # As tools/demo.sh builds it, but the preview's crate keeps its features, so that hardly another is compiled anew.
        linted test --locked --workspace --no-run --lib --no-default-features \
            --features reflet-preview/window,reflet-preview/serve
    elif [ "$1" = python ]; then
        shift
        [ ! -f tools/pyproject.toml ] || "$@" -m program tests/tools
    else
        linted test --locked --workspace --no-fail-fast "$@"
    fi
}
# Runs such a part; shows what it says, and its seconds, when it ends.
run_tests() {
    local said status=0
    said="$(SECONDS=0 && run_part "$@" 2>&1 && printf -- '-- %s: %d s' "$*" "$SECONDS")" || status="$?"
    printf '%s\n' "$said"
    return "$status"
}
export -f linted run_part run_tests
export clippy_driver
# Three processes at a time: a software adapter compiles shaders on one thread of each. The longest parts begin, and
# the last ones keep several threads busy.
xargs -L 1 -P 3 bash -c 'run_tests "$@"' _ <<END
--test p* -- light::
--test p* -- --skip light::
--test c*
without-preview
--lib --test [!cp]*
python ${pytest[*]}
END

heading "Example of the library"
# It was built with the tests; `cargo run --package` would build its dependencies anew, with fewer features.
"${CARGO_TARGET_DIR:-$root/target}/debug/examples/render_to_pixels"

if [ "$full" = yes ]; then
    heading "Second compiler of shaders"
    # Dawn (BSD-3-Clause), 130 MB, for one of the long tests, which is skipped without it.
    npm install --no-audit --no-fund --no-save --silent --prefix target/tools webgpu@0.6.2 ||
        echo "NOT CHECKED: shaders by Dawn, which cannot be installed"

    heading "Blender"
    # Its tests are skipped without it, also below among the others.
    tools/setup.sh --blender || echo "NOT CHECKED: the add-on for Blender, which cannot be installed"
    "${pytest[@]}" tests/tools/test_blender.py tests/tools/test_blender_exports.py

    heading "Extension for VS Code"
    # Its tests drive the program that was built.
    if (cd tools/vscode && npm ci --no-audit --no-fund --silent); then
        (cd tools/vscode && npm test && npm run package)
        # A session in the real editor is skipped without it, also below among the others.
        tools/setup.sh --vscode || echo "NOT CHECKED: the extension in VS Code, which cannot be installed"
        "${pytest[@]}" tests/tools/test_vscode.py
    else
        echo "NOT CHECKED: tools/vscode, whose packages cannot be installed"
    fi

    heading "Long tests"
    linted test --locked --workspace -- --ignored

    heading "Program without its window"
    cargo clippy --locked --no-default-features -- -D warnings

    heading "Links of the documentation"
    RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --workspace

    heading "Another driver"
    if tools/driver.sh newest >/dev/null; then
        tools/driver.sh newest check scenes/fail/*.toml scenes/{atrium,cornell,interior,mirrors,street,studio}.toml
        heading "Ray queries"
        tools/driver.sh newest queries scenes/fail/*.toml scenes/*.toml scenes/paper/*.toml \
            scenes/examples/{bench,bus_stop,museum,turntable}.toml
        (
            eval "$(tools/driver.sh newest)"
            cargo test --locked --test pictures queries::
        )
    else
        echo "NOT CHECKED: another version of Mesa, which cannot be fetched"
    fi

    heading "Release"
    if [ -n "$(git status --porcelain)" ]; then
        echo "NOT CHECKED: packages of the crates, which need a tree without changes"
    else
        CARGO_TARGET_DIR="$root/target/packaged" cargo package --locked --workspace --exclude reflet-web --exclude reflet-python
    fi
    if [ "$(id -u)" = 0 ] && command -v debootstrap && [ -z "$(git status --porcelain)" ]; then
        rm -rf target/release-checked
        tools/release.sh target/release-checked
        tools/try_release.sh target/release-checked
    else
        echo "NOT CHECKED: a release, which needs root, debootstrap and a tree without changes"
    fi

    heading "Broken files"
    tools/fuzz.sh

    heading "Licenses and vulnerabilities of dependencies"
    if ! cargo deny --version; then
        echo "missing: cargo-deny; building it in target/tools"
        cargo install --locked --quiet --debug --root target/tools cargo-deny # runs once: not worth optimizing
        export PATH="$root/target/tools/bin:$PATH"
    fi
    checks=(advisories bans licenses sources)
    if ! cargo deny --locked --config tools/deny.toml fetch db; then
        echo "NOT CHECKED: known vulnerabilities, whose database cannot be fetched"
        checks=(bans licenses sources)
    fi
    for manifest in Cargo.toml fuzz/Cargo.toml; do
        cargo deny --locked --manifest-path "$manifest" --config tools/deny.toml check "${checks[@]}"
    done
fi

heading "All good in $SECONDS s"
