"""Owns where the tests find the program and the library that `cargo test` has built."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug"
BINARY = Path(os.environ.get("REFLET", BUILT / "reflet"))
