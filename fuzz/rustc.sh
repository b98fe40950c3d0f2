#!/bin/sh
# Wrapper for rustc (RUSTC_WRAPPER): builds Reflet's own code with coverage counters, as `cargo fuzz` does, but
# without a sanitizer, which needs a nightly compiler. Dependencies are not instrumented: they would take long to
# build, and draw mutations to themselves.
compiler="$1"
shift
case " $* " in
    *" --crate-name reflet_scene "* | *" --crate-name reflet_world "*)
        set -- "$@" -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
            -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
        ;;
esac
exec "$compiler" "$@"
