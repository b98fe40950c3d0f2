"""The child process of a sandboxed conversion: `python -m reflet_usd.convert STAGE -o OUT ...`.

The last line on stdout is one JSON object: `{"ok": true}` (the result is in the sidecar) or
`{"error": {"name", "message", "path"}}`. Exit code 0 or 1. Progress goes to stderr.
"""

from __future__ import annotations

import argparse
import json
import sys

from reflet_usd.convert import ConvertError, convert_stage
from reflet_usd.convert.arguments import add_arguments, options_from


def main() -> int:
    """Convert in this process and report on stdout."""
    parser = argparse.ArgumentParser(prog="python -m reflet_usd.convert")
    add_arguments(parser)
    args = parser.parse_args()
    try:
        convert_stage(args.stage, args.output, options_from(args))
    except ConvertError as error:
        report = {"name": error.name, "message": error.message, "path": error.path}
        print(json.dumps({"error": report}), flush=True)
        return 1
    except MemoryError:
        report = {"name": "out-of-memory", "message": "not enough memory", "path": str(args.stage)}
        print(json.dumps({"error": report}), flush=True)
        return 1
    print(json.dumps({"ok": True}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
