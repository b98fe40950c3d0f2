"""Owns functions that misbehave in the sandbox's child process in place of the converter."""

import ctypes
import os
import socket
import time
from pathlib import Path

from reflet_usd.convert.types import ConvertError, ConvertOptions, ConvertResult


def write_small(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(stage.read_bytes())
    Path(f"{out}.json").write_text("{}")
    return ConvertResult([], {"Mesh": {"carried": 1, "warned": 0}})


def eat_memory(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(b"begun")
    hoard = []
    while True:
        hoard.append(bytearray(1 << 26))


def fail_to_allocate(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    os.write(2, b"terminate called after throwing an instance of 'std::bad_alloc'\n")
    os.abort()


def spin(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(b"begun")
    while True:
        pass


def sleep(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(b"begun")
    time.sleep(600)
    raise AssertionError


def crash(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(b"begun")
    ctypes.string_at(0)
    raise AssertionError


def write_one_large(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(bytes(3 << 20))
    raise AssertionError


def write_many(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    for number in range(400):
        out.with_name(f"{number}.bin").write_bytes(bytes(1 << 18))
        time.sleep(0.01)
    raise AssertionError


def read_outside(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    secret = stage.parent.parent / "secret.txt"
    raise ConvertError("leak", secret.read_text())


def write_outside(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    (stage.parent / "planted.txt").write_text("x")
    raise AssertionError


def read_extra_root(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_text((options.extra_roots[0] / "texture.txt").read_text())
    return ConvertResult()


def connect(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    with socket.create_connection(("192.0.2.1", 80), timeout=5):
        raise AssertionError


def write_nothing(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    return ConvertResult()


def write_link(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.symlink_to("/etc/passwd")
    return ConvertResult()


def refuse(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    out.write_bytes(b"begun")
    raise ConvertError("stage-odd", "the stage is odd", str(stage))


def blunder(stage: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    return {}["missing"]
