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

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
readonly root
"$root/tools/setup.sh"
export PATH="$HOME/.cargo/bin:$PATH"
# setup.sh has installed a software adapter: without one, tests fail here instead of skipping.
export REFLET_REQUIRE_GPU=1
cd "$root"

heading() { printf '\n== %s ==\n' "$1"; }

heading "Format"
cargo fmt --all -- --check

heading "Lints"
# Clippy uses the dev profile, like the tests and the demo, so dependencies are built once.
cargo clippy --locked --all-targets --all-features -- -D warnings

heading "Lints without the window, the measuring and the command line"
feature_sets=(bench "")
if [ "$full" = yes ]; then
    feature_sets+=(cli) # a set between the other two
fi
for features in "${feature_sets[@]}"; do
    cargo clippy --locked --no-default-features --features "$features" -- -D warnings
done
library="$(cargo tree --locked --no-default-features)"
if grep -E '(egui|winit|clap|plotters) v' <<<"$library"; then
    echo "these must not be dependencies of the library alone" >&2
    exit 1
fi

heading "Tests of modules"
# Unoptimized, the module tests build in a third of the time; they compute little.
CARGO_PROFILE_TEST_OPT_LEVEL=0 cargo test --locked --all-features --lib

heading "Tests"
cargo test --locked --all-features --test '*' --no-run
# Two processes: a software adapter compiles shaders on one thread of each. `pictures` takes half of the time.
others="$(mktemp)"
cargo test --locked --all-features --test '[!p]*' >"$others" 2>&1 &
beside=$!
trap 'pkill -P "$beside" || true; kill "$beside" || true; rm -f "$others"' EXIT
failed=no
cargo test --locked --all-features --test 'p*' || failed=yes
wait "$beside" || failed=yes
cat "$others"
rm "$others"
trap - EXIT
[ "$failed" = no ]

heading "Example of the library"
cargo run --locked --all-features --example render_to_pixels

if [ "$full" = yes ]; then
    heading "Long tests"
    cargo test --locked --all-features -- --ignored

    heading "Broken files"
    tools/fuzz.sh

    heading "Licenses and vulnerabilities of dependencies"
    if cargo deny --version >/dev/null 2>&1; then
        cargo deny check --config tools/deny.toml
    else
        echo "missing: cargo-deny; cargo install --locked cargo-deny"
    fi
fi

if [ -f tools/pyproject.toml ]; then
    heading "Python lints"
    .venv/bin/ruff check --config tools/pyproject.toml tools tests/tools

    heading "Python types"
    .venv/bin/mypy --config-file tools/pyproject.toml tools

    heading "Python tests"
    pytest=(.venv/bin/python -m pytest -q -rs -n auto --maxprocesses 8 --dist worksteal)
    if [ "$full" = yes ]; then
        pytest+=(--full)
    fi
    "${pytest[@]}" tests/tools
fi

heading "All good"
