#!/bin/sh
# As RUSTC_WRAPPER: has Reflet's own code count what inputs reach, as `cargo fuzz` does, without a sanitizer, which
# needs a nightly compiler. Dependencies stay as they are: instrumented they take long to build, and draw mutations to themselves.
compiler="$1"
shift
case " $* " in
    *" --crate-name reflet "*)
        set -- "$@" -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
            -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
        ;;
esac
exec "$compiler" "$@"
