"""The command line in this process: a new one spends a second on importing what is here already.

What only a process shows (signals, limits, a closed pipe, what the shell gets as exit code) is
tested with real ones in output/test_cli.py, hard/test_bad_input.py and hard/test_same_bits.py.
"""

from __future__ import annotations

import io
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from subprocess import CompletedProcess

from perilune import cli


class _Text(io.StringIO):
    """What stands for a pipe: text that is no terminal."""

    def isatty(self) -> bool:
        return False


def command(*words: object, cwd: Path | str = ".") -> CompletedProcess[str]:
    """`perilune WORDS...`, started in the folder `cwd`: its exit code and what it has printed."""
    out, err = _Text(), _Text()
    path = sys.path[:]
    with chdir(cwd), redirect_stdout(out), redirect_stderr(err):
        try:
            code = cli.main([str(word) for word in words])
        except SystemExit as left:
            code = left.code if isinstance(left.code, int) else 1
        finally:
            sys.path[:] = path
    return CompletedProcess(words, code, out.getvalue(), err.getvalue())
