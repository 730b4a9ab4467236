"""Maps that simulations of a process share: what is kept, what is read again, what is let go."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from tests.python.optics_scenes import at, ball, opened, tree

from perilune import _core
from perilune.base.file_cache import FileCache
from perilune.bodies.map_cache import MAPS, Read


def write(path: Path, grey: int, side: int = 8) -> None:
    PIL.Image.fromarray(np.full((side // 2, side), grey, np.uint8)).save(path)


def map_cache(most_bytes: int = 1 << 20) -> FileCache[Read]:
    return FileCache(lambda read: read[0].nbytes, most_bytes)


def test_a_file_is_read_once_until_it_changes(tmp_path: Path) -> None:
    path, cache, reads = tmp_path / "map.png", map_cache(), []

    def read() -> tuple[_core.Map, tuple[str, ...]]:
        reads.append(1)
        return _core.Map(str(path)), ()

    write(path, 100)
    first, _ = cache.of(path, ("a",), read)
    assert cache.of(path, ("a",), read)[0] is first
    assert cache.of(path.parent / "." / path.name, ("a",), read)[0] is first
    assert cache.of(path, ("b",), read)[0] is not first
    assert len(reads) == 2
    state = path.stat()
    write(path, 200)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns + 1))
    assert cache.of(path, ("a",), read)[0].mean[0] > first.mean[0]
    path.unlink()
    with pytest.raises(OSError, match=r"map\.png"):
        cache.of(path, ("a",), read)


def test_a_child_of_a_fork_reads_maps(tmp_path: Path) -> None:
    """Though another thread of the parent was in the cache; it would wait for ever."""
    write(tmp_path / "map.png", 100)
    with MAPS._lock:
        child = os.fork()
        if child == 0:
            signal.alarm(10)
            MAPS.of(tmp_path / "map.png", (), lambda: (_core.Map(str(tmp_path / "map.png")), ()))
            os._exit(0)
    assert os.waitpid(child, 0)[1] == 0


def test_what_was_asked_for_longest_ago_is_let_go(tmp_path: Path) -> None:
    paths = [tmp_path / f"{k}.png" for k in range(3)]
    for path in paths:
        write(path, 50, side=64)
    one = _core.Map(str(paths[0])).nbytes
    assert one >= 64 * 32
    cache, reads = map_cache(2 * one), []

    def ask(k: int) -> None:
        def read() -> tuple[_core.Map, tuple[str, ...]]:
            reads.append(k)
            return _core.Map(str(paths[k])), ()

        cache.of(paths[k], (), read)

    for k in (0, 1, 0, 2, 0, 1):
        ask(k)
    assert reads == [0, 1, 2, 1]


def test_simulations_share_maps(tmp_path: Path) -> None:
    made = tree((24, 24), 40.0, far=ball(at(30.0), 6.0, albedo=1.0))
    made["bodies"]["far"] |= {"color_map": "map.png", "emission_w_m2_sr": 0.0}
    made["camera"]["exposure"]["white_radiance_w_m2_sr"] = 500.0

    def seen(grey: int, time_ns: int) -> tuple[Any, _core.Map]:
        write(tmp_path / "map.png", grey)
        os.utime(tmp_path / "map.png", ns=(time_ns, time_ns))
        sim = opened(made, tmp_path)
        image = sim.frame(0, ["rgb"])["rgb"]
        (used,) = sim._mine().assets.files.values()
        return image, used

    dark, first = seen(60, 1)
    again, second = seen(60, 1)
    assert second is first
    assert dark.any()
    assert (again == dark).all()
    bright, third = seen(250, 2)
    assert third is not first
    assert bright.mean() > dark.mean()
