"""The command line `reflet-usd`: one subcommand per module, exit codes, nothing else.

Exit codes are the same for all of them, see `EXIT_CODES`.
"""

import argparse
import contextlib
import hashlib
import importlib
import io
import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from importlib import metadata
from pathlib import Path
from types import FrameType
from typing import Any

from reflet_usd import __version__
from reflet_usd.convert.types import ConvertError

# Subcommand, the module that owns it (`add_arguments(parser)`, `run(args) -> int`), its help line.
COMMANDS: tuple[tuple[str, str, str], ...] = (
    ("convert", "reflet_usd.convert.command", "write a USD stage as glTF (.glb or .gltf)"),
    ("validate", "reflet_usd.validate", "check a glTF file, alone or against its USD stage"),
    ("inspect", "reflet_usd.inspect", "list what a USD stage holds and how each part would travel"),
    ("report", "reflet_usd.report", "convert and check every stage of a folder, print the table"),
)

EXIT_FAILED = 1
EXIT_CODES = """exit codes:
  0    done; for validate and report: and everything is as it should be
  1    the work could not be done, for the reason named in brackets
  2    wrong usage
  3    validate: the file is invalid, or deviates in a way that no warning declares;
       report: some stage is not as it should be
  130  stopped by SIGINT
  143  stopped by SIGTERM
"""


class _ShowVersion(argparse.Action):
    """Prints this converter's identity; Reflet keeps cached conversions while it stays the same."""

    def __init__(self, option_strings: Sequence[str], dest: str, **options: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, default=argparse.SUPPRESS, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print and exit."""
        print(f"reflet-usd {__version__} ({_identity()})")
        parser.exit()


def _identity() -> str:
    """Hash of the package's code, and the versions of the libraries that read and write."""
    package = Path(__file__).parent
    code = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        content = path.read_bytes()
        code.update(f"{path.relative_to(package).as_posix()} {len(content)}\n".encode())
        code.update(content)
    parts = [f"code {code.hexdigest()[:16]}"]
    for name in ("usd-core", "numpy", "pillow", "scipy", "materialx"):
        with contextlib.suppress(metadata.PackageNotFoundError):
            parts.append(f"{name} {metadata.version(name)}")
    return ", ".join(parts)


def build_parser(selected: str | None) -> argparse.ArgumentParser:
    """The whole parser; only `selected`'s module is imported (USD takes long to load)."""
    parser = argparse.ArgumentParser(
        prog="reflet-usd",
        description="USD stages to glTF 2.0, with validation that nothing got lost.",
        epilog=EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version", action=_ShowVersion, help="show version and a hash of the code, and exit"
    )
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, module, text in COMMANDS:
        subparser = subparsers.add_parser(
            name,
            help=text,
            description=text,
            epilog=EXIT_CODES,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if name == selected:
            importlib.import_module(module).add_arguments(subparser)
    return parser


@contextlib.contextmanager
def _clean_end_by_signals() -> Iterator[None]:
    """SIGINT and SIGTERM unwind the program, so that it ends its children and removes its files."""
    signals = (signal.SIGINT, signal.SIGTERM)

    def stop(number: int, _frame: FrameType | None) -> None:
        for each in signals:
            signal.signal(each, signal.SIG_IGN)  # a second one must not stop the cleaning up
        with contextlib.suppress(OSError):  # the reader of the output may have ended
            print(f"stopped by {signal.Signals(number).name}", file=sys.stderr, flush=True)
        raise SystemExit(128 + number)

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = [signal.signal(each, stop) for each in signals]
    try:
        yield
    finally:
        for each, handler in zip(signals, before, strict=True):
            signal.signal(each, handler)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit code; a signal raises SystemExit after cleaning up."""
    for stream in (sys.stdout, sys.stderr):  # file names may be in any encoding
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    with _clean_end_by_signals():
        try:
            return _run(argv)
        except ConvertError as error:
            print(f"error: {error}", file=sys.stderr)
        except Exception as error:  # last boundary: every error gets a name
            frame = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(frame.filename).name}:{frame.lineno}"
            reason = " ".join(str(error).split())[:300]
            print(
                f"error: {type(error).__name__} at {place}: {reason} [converter-internal]",
                file=sys.stderr,
            )
        return EXIT_FAILED


def _run(argv: Sequence[str] | None) -> int:
    arguments = list(sys.argv[1:] if argv is None else argv)
    names = [name for name, _, _ in COMMANDS]
    selected = next((word for word in arguments if word in names), None)
    args = build_parser(selected).parse_args(arguments)
    module = next(module for name, module, _ in COMMANDS if name == args.command)
    return int(importlib.import_module(module).run(args))


if __name__ == "__main__":
    raise SystemExit(main())
