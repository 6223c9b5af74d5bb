"""Processes with their CPU time and memory, as the system counts them."""

import ctypes
import os
import sys
import tempfile
import time
from pathlib import Path

PR_SET_CHILD_SUBREAPER = 36


def adopts() -> bool:
    """Whether children of our children come to us when they lose their parents; so it is from now on where that can be."""
    if not sys.platform.startswith("linux") or not Path("/bin/sh").exists():
        return False
    return ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) == 0


ADOPTS = adopts()


def run(command: list[str]) -> tuple[int, str, float, float, float]:
    """Exit status, standard output, CPU time and wall time in s, memory in MB.

    Linux counts what a process held before it became another program as that program's. A child of this interpreter would so have
    the interpreter's 14 MB at least; a child of a shell has 1 MB.
    """
    if ADOPTS:
        # it begins when its shell is gone and we are told who it is: a shell that still lived might take its end for itself
        command = ["/bin/sh", "-c", '{ read _ <&4; exec "$@"; } & echo $! >&3', "sh", *command]
    with tempfile.TemporaryFile() as output, open(os.devnull, "wb") as nothing, tempfile.TemporaryFile() as number:
        begin, told = os.pipe()
        # each source lies above the targets before it, for all are opened in this order
        files = [(output.fileno(), 1), (nothing.fileno(), 2), (number.fileno(), 3), (begin, 4)]
        actions = [(os.POSIX_SPAWN_DUP2, *pair) for pair in files]
        began = time.monotonic()
        pid = os.posix_spawn(command[0], command, os.environ, file_actions=actions)
        if ADOPTS:
            os.waitpid(pid, 0)
            number.seek(0)
            pid = int(number.read())
            began = time.monotonic()
            os.write(told, b"\n")
        os.close(begin)
        os.close(told)
        _, status, usage = os.wait4(pid, 0)
        wall = time.monotonic() - began
        output.seek(0)
        text = output.read().decode(errors="replace")
    return os.waitstatus_to_exitcode(status), text, usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024
