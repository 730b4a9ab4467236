"""Seconds an image and peak memory of the main job, beside the papers' numbers.

`voyager_phobos.yaml` at 640x480 with all labels, as Space OAISYS reports it: 2.5 s an image and
822 MB on Blender (their machine is not ours: read the order of magnitude). Medians over frames.
"""

from __future__ import annotations

import report

import perilune

PAPER_S, PAPER_MB = 2.5, 822.0
JOBS = {
    "rgb and all labels": ["rgb", "radiance", *report.LABELS],
    "rgb alone": ["rgb"],
    "labels alone": report.LABELS,
    "labels alone, out=": report.LABELS,
}
"""Those that end with `out=` write into the arrays of an earlier frame."""


def measure(
    sim: perilune.Simulation, channels: list[str], frames: int, threads: int, reuse: bool
) -> dict[str, float]:
    """Median seconds of the whole frame (Python included) and of each stage of the core."""
    out = dict(sim.frame(0, channels=channels, threads=threads)) if reuse else None
    stages: dict[str, list[float]] = {}
    whole = []
    for index in range(frames):
        whole += report.seconds(
            lambda i=index: stages_of(
                sim.frame(i, channels=channels, threads=threads, out=out), stages
            ),
            1,
        )
    return {"frame": report.median(whole)} | {
        name: report.median(values) for name, values in stages.items()
    }


def stages_of(sample: perilune.Sample, stages: dict[str, list[float]]) -> None:
    for name, value in sample.meta["timings_s"].items():
        stages.setdefault(name, []).append(value)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "voyager_phobos.yaml"))
    parser.add_argument("--frames", type=int, default=12)
    options = parser.parse_args()
    sim = perilune.open(
        options.config, overrides={"camera.width": 640, "camera.height": 480, "render.samples": 16}
    )
    sim.frame(0, threads=options.threads)  # models and maps are loaded once
    results = {
        name: measure(sim, channels, options.frames, options.threads, name.endswith("out="))
        for name, channels in JOBS.items()
    }
    memory = report.peak_memory_mb()
    full = results["rgb and all labels"]
    stages = [name for name in full if name != "frame"]
    rows = [
        [name, times["frame"], *[times[stage] for stage in stages]]
        for name, times in results.items()
    ]
    summary = [
        ["Perilune", full["frame"], memory],
        ["Space OAISYS (paper)", PAPER_S, PAPER_MB],
    ]
    report.publish(
        options.json,
        {
            "config": options.config,
            "threads": options.threads,
            "seconds": results,
            "peak_memory_mb": memory,
            "paper_seconds": PAPER_S,
            "paper_memory_mb": PAPER_MB,
            "paper_over_ours_ratio": PAPER_S / full["frame"],
        },
        [
            report.table(["", "s an image", "peak MB"], summary),
            report.table(["seconds, median", "frame", *stages], rows),
        ],
    )


if __name__ == "__main__":
    main()
