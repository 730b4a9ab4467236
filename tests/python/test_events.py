"""Events against a simulation of our own from frames at 10 000 a second, and their noise."""

from __future__ import annotations

import numpy as np
import pytest
from tests.python.optics_scenes import at, ball, opened, tree
from tests.python.test_shutter import sliding

DARK = 20.0


def scene(size=(32, 16), step_s=0.02, **keys):
    """A ball with a terminator that crosses the picture by two pixels, seen for 20 ms."""
    found = tree(size, 60.0, ball=ball(at(20.0, 0.3), 2.0, albedo=0.8, emission_w_m2_sr=0.0))
    found["time"]["step_s"] = step_s
    found["sun"] = {"direction": [-0.4, 0.9, 0.2]}
    found["render"] |= {"samples": 64, "force_off": ["soft_sun"]}
    found["events"] = {"dark_radiance_w_m2_sr": DARK, "on_threshold": 0.3, "off_threshold": 0.25}
    found["events"] |= keys
    return found


def brute(logs, times, on, off, refractory_s=0.0):
    """Events of one pixel from closely spaced samples, in steps; its own code."""
    found, reference, asleep = [], logs[0], -np.inf
    for k in range(1, len(times)):
        t, value = times[k], logs[k]
        while t >= asleep:
            if value - reference >= on:
                goal, sign = reference + on, 1
            elif reference - value >= off:
                goal, sign = reference - off, -1
            else:
                break
            part = (goal - logs[k - 1]) / (value - logs[k - 1])
            found.append((times[k - 1] + max(part, 0.0) * (t - times[k - 1]), sign))
            reference = goal
            if refractory_s > 0.0:
                asleep, reference = t + refractory_s, value
    return found


@pytest.fixture(scope="module")
def filmed(repo_dir):
    """Logarithms of 201 frames at 10 000 a second, (frames, height, width)."""
    sim = opened(scene(), repo_dir, trajectory=sliding(30.0))
    logs = []
    for k in range(201):
        moment = {"time.step_s": max(k, 1e-6) * 1e-4, "render.tolerance_dn": 0.0}
        still = sim.with_overrides(moment | {"camera.exposure_time_s": 0.0})
        light = still.frame(1, ["radiance"])["radiance"].astype(float)
        logs.append(np.log(light @ [0.2126, 0.7152, 0.0722] + DARK))
    return np.array(logs)


def test_events_are_those_of_ten_thousand_frames_a_second(repo_dir, filmed):
    sim = opened(scene(instants=8, max_halvings=6, tolerance=0.02, tolerated_pixels=0.0),
                 repo_dir, trajectory=sliding(30.0))  # fmt: skip
    events = sim.events(0)
    assert (np.diff(events["t_us"]) >= 0).all()
    times = np.arange(201) * 1e-4
    expected = same = 0
    errors = []
    for y in range(16):
        for x in range(32):
            truth = brute(filmed[:, y, x], times, 0.3, 0.25)
            own = events[(events["x"] == x) & (events["y"] == y)]
            expected += len(truth)
            if [s for _, s in truth] != own["polarity"].tolist():
                continue
            same += len(truth)
            errors += [abs(t * 1e6 - u) for (t, _), u in zip(truth, own["t_us"], strict=True)]
    assert expected > 300
    # The frames have other random numbers: where light is near a threshold, one event may differ.
    assert same > 0.93 * expected
    assert np.median(errors) < 25.0  # a quarter of the step between frames
    assert np.quantile(errors, 0.95) < 700.0
    assert abs(len(events) - expected) < 0.02 * expected


def test_more_instants_are_nearer(repo_dir, filmed):
    """Times of all events of each kind: their mean error falls with the pictures."""
    times = np.arange(201) * 1e-4
    truth = sorted(t for y in range(16) for x in range(32)
                   for t, _ in brute(filmed[:, y, x], times, 0.3, 0.25))  # fmt: skip
    off = []
    for instants in (2, 8, 32):
        sim = opened(scene(instants=instants, max_halvings=0), repo_dir, trajectory=sliding(30.0))
        found = np.sort(sim.events(0)["t_us"]) * 1e-6
        grid = np.linspace(0.0, 0.02, 41)
        counts = np.searchsorted(found, grid), np.searchsorted(truth, grid)
        off.append(float(np.abs(counts[0] - counts[1]).mean()))
    assert off[2] < 0.5 * off[0]


def test_threads_change_nothing(repo_dir):
    keys = {
        "max_halvings": 2,
        "mismatch": 0.1,
        "noise_hz": 20.0,
        "leak_hz": 10.0,
        "refractory_us": 500.0,
    }
    sim = opened(scene(**keys), repo_dir, trajectory=sliding(30.0))
    first = sim.events(1, threads=1)
    assert first.tobytes() == sim.events(1, threads=3).tobytes()
    assert first.tobytes() != sim.events(0).tobytes()
    assert first.tobytes() != sim.with_overrides(seed=3).events(1).tobytes()


def test_nothing_moves_nothing_is_reported_but_noise(repo_dir):
    quiet = scene(step_s=2.0, instants=1, max_halvings=0)
    assert len(opened(quiet, repo_dir).events(0)) == 0
    noisy = scene(step_s=2.0, instants=1, max_halvings=0, noise_hz=3.0)
    found = opened(noisy, repo_dir).events(0)
    mean = 3.0 * 2.0 * 32 * 16
    assert abs(len(found) - mean) < 4 * np.sqrt(mean)
    assert abs((found["polarity"] > 0).mean() - 0.5) < 4 * 0.5 / np.sqrt(len(found))
    assert abs(found["t_us"].mean() - 1e6) < 4 * 2e6 / np.sqrt(12 * len(found))
    leaking = opened(scene(step_s=2.0, instants=1, max_halvings=0, leak_hz=3.1), repo_dir).events(0)
    assert len(leaking) == 6 * 32 * 16
    assert (leaking["polarity"] == 1).all()


def test_mismatch_and_refractory_time(repo_dir):
    ramp = scene(instants=32, max_halvings=0)
    plain = opened(ramp, repo_dir, trajectory=sliding(30.0)).events(0)
    ramp["events"]["refractory_us"] = 1000.0
    held = opened(ramp, repo_dir, trajectory=sliding(30.0)).events(0)
    assert 0 < len(held) < len(plain)
    for x, y in {(int(e["x"]), int(e["y"])) for e in held}:
        own = held["t_us"][(held["x"] == x) & (held["y"] == y)]
        assert (np.diff(own) >= 1000.0).all()
    leaks = scene(step_s=2.0, instants=1, max_halvings=0, leak_hz=0.6, mismatch=0.2)
    found = opened(leaks, repo_dir).events(0)
    assert len(found) == 32 * 16  # the leak is relative to a pixel's own threshold
    with pytest.raises(ValueError, match="events"):
        opened(tree(), repo_dir).events(0)
