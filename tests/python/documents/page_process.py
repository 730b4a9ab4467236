"""Processes that run scripts of pages: each is the child of one that has opened the demo once.

What a page takes is then its own code: not the import of Perilune and the maps of the demo, 4 s of
a process that starts anew. The child is a process of its own all the same, in which nothing was
imported that opening a configuration and rendering a frame do not import.
"""

from __future__ import annotations

import json
import os
import runpy
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

TIMEOUT_S = 300


class Pages:
    """Starts the process; `run` is asked for one script at a time."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._server: subprocess.Popen[str] | None = None

    def run(self, script: Path, search: Path) -> tuple[int, str]:
        """Exit status (negative: a signal) of a script, whose modules are in `search`, and what it
        wrote to standard error."""
        errors = script.with_suffix(".stderr")
        if self._server is None:
            self._server = subprocess.Popen(
                [sys.executable, __file__],
                cwd=self._root,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        asked, answers = self._server.stdin, self._server.stdout
        assert asked is not None
        assert answers is not None
        asked.write(json.dumps([str(script), str(search), str(errors)]) + "\n")
        asked.flush()
        answer = answers.readline()
        assert answer, "the process that opens the demo has ended"
        return int(answer), errors.read_text()

    def close(self) -> None:
        if self._server is not None:
            assert self._server.stdin is not None
            self._server.stdin.close()
            assert self._server.wait(TIMEOUT_S) == 0


def child(script: str, search: str, errors: str) -> None:
    """As if Python had been started with the script, and `search` in PYTHONPATH."""
    signal.alarm(TIMEOUT_S)
    with open(errors, "w") as log, open(os.devnull) as nothing:
        os.dup2(nothing.fileno(), 0)
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
    os.environ["PYTHONPATH"] = search
    sys.path[:1] = [str(Path(script).parent), search]
    sys.argv = [script]
    runpy.run_path(script, run_name="__main__")


def serve() -> None:
    import perilune

    size = {"camera.width": 8, "camera.height": 6, "render.samples": 1}
    demo: Any = perilune.open("configs/demo.yaml", overrides=size)
    demo.frame(0, threads=1)  # and its maps are read
    for line in iter(sys.stdin.readline, ""):
        process = os.fork()
        if process == 0:
            child(*json.loads(line))
            return
        print(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), flush=True)


if __name__ == "__main__":
    serve()
