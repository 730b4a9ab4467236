"""What Python takes of a small frame of labels, and what an import takes: milliseconds of CPU time.

A frame of 64x64 pixels without colours, on one thread: the CPU time of the frame outside the core's
call that renders it. Frames go on from one to the next, so that drivers draw anew.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from typing import Any

import report

import perilune
from perilune.frame import passes

CONFIGS = ("demo", "rendezvous")
CHANNELS = ["depth", "normal", "semantic", "part", "instance", "objects"]
WARM, FRAMES = 20, 150
STAGES = {
    "import perilune": "import perilune",
    "and its names": "import perilune; perilune.open, perilune.Dataset, perilune.Stream",
    "and a configuration": "import perilune; perilune.open('configs/demo.yaml')",
}
TIMED = "import time\nt = time.process_time()\n{}\nprint(time.process_time() - t)"


def of_frames(name: str, monitored: list[float]) -> dict[str, float]:
    """Medians of Python's share and of the core's call, ms."""
    sim = perilune.open(report.ROOT / f"configs/{name}.yaml")
    places = [f"sensors.{key}" for key in sim.config.sensors] or ["camera"]
    sizes = {f"{place}.{side}": 64 for place in places for side in ("width", "height")}
    sim = sim.with_overrides({**sizes, "render.channels": CHANNELS})
    shares, cores = [], []
    for index in range(WARM + FRAMES):
        monitored[0] = 0.0
        start = time.thread_time()
        sim.frame(index, threads=1)
        if index >= WARM:
            shares.append(1e3 * (time.thread_time() - start - monitored[0]))
            cores.append(1e3 * monitored[0])
    return {
        "python_ms": statistics.median(shares),
        "python_least_ms": min(shares),
        "core_ms": statistics.median(cores),
    }


def of_import(code: str) -> float:
    """The least of some fresh processes, ms."""
    command = [sys.executable, "-c", TIMED.format(code)]
    # compiled modules are kept, as by default
    own = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    runs = [
        subprocess.run(
            command, cwd=report.ROOT, env=own, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(5)
    ]
    return 1e3 * min(map(float, runs))


def main() -> None:
    options = report.arguments(__doc__ or "").parse_args()
    monitored = [0.0]
    render = passes.render

    def timed(*arguments: Any, **more: Any) -> Any:
        start = time.thread_time()
        try:
            return render(*arguments, **more)
        finally:
            monitored[0] += time.thread_time() - start

    passes.render = timed
    frames = {name: of_frames(name, monitored) for name in CONFIGS}
    imports = {name: of_import(code) for name, code in STAGES.items()}
    rows = [[name, *(f"{value:.2f}" for value in row.values())] for name, row in frames.items()]
    rows += [[name, f"{value:.0f}", "", ""] for name, value in imports.items()]
    table = report.table(["of", "Python, ms", "least", "core, ms"], rows)
    report.publish(options.json, {"frames": frames, "imports_ms": imports}, [table])


if __name__ == "__main__":
    main()
