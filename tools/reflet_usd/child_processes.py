"""Owns the child processes that a command's threads started: a signal can end them at once."""

import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Iterator

Process = subprocess.Popen[bytes]


class StoppedError(Exception):
    """The command is ending, so no child process is started any more."""


class Children:
    """Child processes in separate sessions, with their descendants."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: set[Process] = set()
        self._stopped = False

    @contextlib.contextmanager
    def started(self, command: list[str], **options: object) -> Iterator[Process]:
        """A child process that has ended when the block ends; raises StoppedError after `stop`."""
        with self._lock:
            if self._stopped:
                raise StoppedError
            child: Process = subprocess.Popen(command, start_new_session=True, **options)  # type: ignore[call-overload]
            self._running.add(child)
        try:
            yield child
        finally:
            end(child)
            with self._lock:
                self._running.discard(child)

    def stop(self) -> None:
        """End all running children and start no more; threads that wait for them wake up."""
        with self._lock:
            self._stopped = True
            for child in self._running:
                _kill(child)


def end(child: Process) -> None:
    """End a child and its descendants, also after a signal handler raised within `child.wait`.

    Such an exception can leave the lock of `Popen.wait` held, so that another call of it would
    never return; the system call knows no lock.
    """
    if child.returncode is None:
        _kill(child)
        with contextlib.suppress(ChildProcessError):  # reaped before its return code was kept
            os.waitpid(child.pid, 0)


def _kill(child: Process) -> None:
    if child.returncode is None:  # else its number may belong to another process by now
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)
