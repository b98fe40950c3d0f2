"""Owns the variables of the environment that the driver and the converter of USD stages read."""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path

TOOL = "REFLET_USD"
"""Variable with the path of the converter."""


def prepare(driver: Iterable[tuple[str, str]]) -> None:
    """Set variables of the driver, and the converter beside this package, unless they are set."""
    brought = Path(sys.prefix) / "lib/reflet/driver/lvp_icd.json"
    if brought.is_file():  # by the package reflet-software
        os.environ.setdefault("VK_ADD_DRIVER_FILES", str(brought))
    for name, value in driver:
        os.environ.setdefault(name, value)
    converter = Path(sysconfig.get_path("scripts")) / "reflet-usd"
    if converter.is_file():
        os.environ.setdefault(TOOL, str(converter))
