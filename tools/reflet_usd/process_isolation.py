"""Owns the kernel-side confinement of a conversion child: limits, no network, few folders.

Everything here is applied by the child to itself before it imports any library that reads
untrusted data. It uses only the standard library and works on Linux; elsewhere each step
reports what it could not do.
"""

import ctypes
import os
import resource
import signal
import socket
import sys
from collections.abc import Iterable
from pathlib import Path

# linux/landlock.h; the three call numbers are the same on every 64-bit architecture.
_SYS_LANDLOCK_CREATE_RULESET = 444
_SYS_LANDLOCK_ADD_RULE = 445
_SYS_LANDLOCK_RESTRICT_SELF = 446
_LANDLOCK_CREATE_RULESET_VERSION = 1
_LANDLOCK_RULE_PATH_BENEATH = 1
_PR_SET_PDEATHSIG = 1
_PR_SET_NO_NEW_PRIVS = 38
_CLONE_NEWUSER = 0x1000_0000
_CLONE_NEWNET = 0x4000_0000

_FS_EXECUTE, _FS_WRITE_FILE, _FS_READ_FILE, _FS_READ_DIR = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_FS_READ = _FS_EXECUTE | _FS_READ_FILE | _FS_READ_DIR
_FS_FILE_ONLY = _FS_EXECUTE | _FS_WRITE_FILE | _FS_READ_FILE | (1 << 14) | (1 << 15)
# Highest file-system access bit by version of the Landlock interface.
_FS_BITS_BY_ABI = {1: 13, 2: 14, 3: 15, 4: 15, 5: 16}
_NET_ALL = 0b11  # bind and connect over TCP, from version 4 on


class _RulesetAttr(ctypes.Structure):
    _fields_ = [("handled_access_fs", ctypes.c_uint64), ("handled_access_net", ctypes.c_uint64)]


class _PathBeneathAttr(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = [("allowed_access", ctypes.c_uint64), ("parent_fd", ctypes.c_int32)]


def apply_limits(memory_bytes: int, cpu_s: int, file_bytes: int) -> None:
    """Set address space (bytes), processor time (seconds) and size of any one file (bytes).

    A lower limit that this process has inherited stays.
    """
    _lower(resource.RLIMIT_CORE, 0, 0)
    _lower(resource.RLIMIT_CPU, cpu_s, cpu_s + 2)
    _lower(resource.RLIMIT_FSIZE, file_bytes, file_bytes)
    _lower(resource.RLIMIT_AS, memory_bytes, memory_bytes)


def _lower(kind: int, soft: int, hard: int) -> None:
    inherited_hard = resource.getrlimit(kind)[1]
    if inherited_hard != resource.RLIM_INFINITY:
        hard = min(hard, inherited_hard)
    soft = min(inherited(kind, soft), hard)
    resource.setrlimit(kind, (soft, hard))


def inherited(kind: int, own: int) -> int:
    """The lower of our limit and the limit that this process has inherited.

    Of processor time it is a second less than the inherited hard limit, because that one kills
    without a signal that tells why.
    """
    soft, hard = resource.getrlimit(kind)
    if kind == resource.RLIMIT_CPU and hard != resource.RLIM_INFINITY:
        hard = max(1, hard - 1)
    return min(limit for limit in (own, soft, hard) if limit != resource.RLIM_INFINITY)


def die_with_parent() -> None:
    """Ask the kernel to kill this process when its parent ends (Linux; elsewhere nothing)."""
    if sys.platform == "linux":
        _libc().prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def drop_network() -> str | None:
    """Move to an empty network namespace; returns the reason where it could not, or None."""
    if sys.platform != "linux":
        return f"no network namespaces on {sys.platform}"
    libc = _libc()
    # Root may unshare the network alone; other users need a user namespace of their own first.
    for flags in (_CLONE_NEWNET, _CLONE_NEWUSER | _CLONE_NEWNET):
        if libc.unshare(flags) == 0:
            return None
    return f"unshare refused: {os.strerror(ctypes.get_errno())}"


def confine_files(read_roots: Iterable[Path], write_roots: Iterable[Path]) -> str | None:
    """Allow reading below `read_roots` and writing below `write_roots` only (Landlock).

    Roots that do not exist are skipped. Returns why it could not, or None when done.
    """
    if sys.platform != "linux":
        return f"no Landlock on {sys.platform}"
    libc = _libc()
    abi = libc.syscall(_SYS_LANDLOCK_CREATE_RULESET, None, 0, _LANDLOCK_CREATE_RULESET_VERSION)
    if abi < 1:
        return "this kernel has no Landlock"
    every = (1 << _FS_BITS_BY_ABI.get(abi, 16)) - 1
    attr = _RulesetAttr(every, _NET_ALL if abi >= 4 else 0)
    size = ctypes.sizeof(attr) if abi >= 4 else 8
    ruleset = libc.syscall(_SYS_LANDLOCK_CREATE_RULESET, ctypes.byref(attr), size, 0)
    if ruleset < 0:
        return f"Landlock refused: {os.strerror(ctypes.get_errno())}"
    try:
        for root in read_roots:
            _allow(libc, ruleset, root, _FS_READ)
        for root in write_roots:
            _allow(libc, ruleset, root, every)
        libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
        if libc.syscall(_SYS_LANDLOCK_RESTRICT_SELF, ruleset, 0) != 0:
            return f"Landlock refused: {os.strerror(ctypes.get_errno())}"
    finally:
        os.close(ruleset)
    return None


def network_reachable() -> bool:
    """Whether this process could still open a route to another machine (no packet is sent)."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # TEST-NET-1, RFC 5737
        except OSError:
            return False
    return True


def _allow(libc: ctypes.CDLL, ruleset: int, root: Path, access: int) -> None:
    try:
        fd = os.open(root, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    try:
        allowed = access if root.is_dir() else access & _FS_FILE_ONLY
        rule = _PathBeneathAttr(allowed, fd)
        libc.syscall(
            _SYS_LANDLOCK_ADD_RULE, ruleset, _LANDLOCK_RULE_PATH_BENEATH, ctypes.byref(rule), 0
        )
    finally:
        os.close(fd)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
