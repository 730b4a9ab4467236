"""What the tracer keeps of raw Embree's speed, on the rays of real frames, and frames a second.

Primary rays of all pixels that may see a mesh and shadow rays from what they hit, on one thread:
`ratio` is raw Embree's time (packets packed beforehand, meshes alone) over the tracer's (packing,
analytic bodies and unpacking included), medians of repeats in one run. Shading is apart.
"""

from __future__ import annotations

import report

import perilune

SIZES = ((256, 256), (640, 480))


def trace_rows(config: str, repeats: int) -> list[list[object]]:
    """Time per ray and ratio for primary and shadow rays of frame 0."""
    sim = perilune.open(config)
    sim.frame(0, channels=["depth"])
    measured = sim.measure_rays(0, repeats)
    return [
        [kind, rays, ours / rays * 1e9, raw / rays * 1e9, raw / ours]
        for kind, (rays, ours, raw) in measured.items()
    ]


def rate(config: str, size: tuple[int, int], channels: list[str], threads: int) -> float:
    """Frames a second of the whole call from Python, median over frames."""
    overrides = {"camera.width": size[0], "camera.height": size[1]}
    sim = perilune.open(config, overrides=overrides)
    sim.frame(0, channels=channels, threads=threads)
    times = report.seconds(lambda: sim.frame(1, channels=channels, threads=threads), 5)
    return 1.0 / report.median(times)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "iss_leo.yaml"))
    parser.add_argument("--repeats", type=int, default=9)
    options = parser.parse_args()
    rows = trace_rows(options.config, options.repeats)
    rates: list[list[object]] = [
        [f"{w}x{h} {name}", rate(options.config, (w, h), channels, options.threads)]
        for w, h in SIZES
        for name, channels in (
            ("rgb and all labels", ["rgb", *report.LABELS]),
            ("rgb alone", ["rgb"]),
            ("labels alone", report.LABELS),
        )
    ]
    report.publish(
        options.json,
        {
            "config": options.config,
            "threads": options.threads,
            "primary_ratio": rows[0][4],
            "shadow_ratio": rows[1][4],
            "frames_per_second": {str(name): value for name, value in rates},
        },
        [
            report.table(["rays", "count", "ns a ray", "raw Embree", "ratio"], rows),
            report.table(["frames a second", ""], rates),
        ],
    )


if __name__ == "__main__":
    main()
