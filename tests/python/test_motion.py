"""Propagators and trees are made once; answers do not depend on who asked for what before."""

from __future__ import annotations

import os
import signal
import threading

import numpy as np
import pytest

from perilune import _core
from perilune.orbits import motion
from perilune.orbits.solar_system import Date

EPOCH = Date(2461000.0, 0.25)
STILL = {"kind": "fixed", "position_m": np.zeros(3)}
KEPLER = {
    "kind": "kepler", "gm": 4e14, "frame": "icrf",
    "elements": {
        "periapsis_m": 7e6, "eccentricity": 0.1, "inclination_rad": 1.0, "raan_rad": 2.0,
        "arg_periapsis_rad": 3.0, "since_periapsis_s": 4.0,
    },
}  # fmt: skip
EXAMPLES = {
    "kepler": KEPLER,
    "circular": {"kind": "circular", "radii_m": (7e6, 6e6, 1.0), "q": (1, 0, 0, 0),
                 "start_rev": 0.1, "rate_rev_s": 1e-4},
    "j2": {**KEPLER, "kind": "j2", "parent_body": "mars", "j2": 1e-3, "radius_m": 3e6,
           "osculating": True},
    "table": {"kind": "table", "t_s": np.arange(-9e3, 9e3, 60.0), "degree": 5,
              "states": np.outer(np.arange(300.0), [1, 2, 3])},
    "numerical": {"kind": "numerical", "gm": 4e14, "state": (7e6, 0, 0, 0, 8e3, 1e2), "rtol": 1e-12,
                  "forces": []},
}  # fmt: skip
TIMES = np.array([0.0, 5000.0, -2000.0, 8000.0, 1.0, -8000.0])


def nodes(**rotation):
    return [
        {"name": "earth", "parent": -1, "motion": STILL, "rotation": {"frame": "inertial"}},
        {"name": "sat", "parent": 0, "motion": KEPLER, "rotation": {"frame": "lvlh", **rotation}},
    ]


def test_every_kind_is_here():
    assert set(EXAMPLES) == {row["name"] for row in _core.PROPAGATORS}
    for kind, spec in EXAMPLES.items():
        assert _core.Propagator(spec, 2451545.0, 0.0).kind == kind
    with pytest.raises(ValueError, match="kind is 'keppler'; allowed: kepler, circular, j2"):
        _core.Propagator({**KEPLER, "kind": "keppler"}, 2451545.0, 0.0)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_same_bits_in_any_order(kind):
    """Times in any order, one by one, by four threads at once, asked of a new one or an old one."""
    spec = EXAMPLES[kind]
    truth = _core.Propagator(spec, 2451545.0, 0.0).states(TIMES)
    order = [3, 1, 5, 0, 2, 4]
    shared = _core.Propagator(spec, 2451545.0, 0.0)
    assert np.array_equal(shared.states(TIMES[order]), truth[order])
    for k in (5, 0, 3):
        assert np.array_equal(_core.Propagator(spec, 2451545.0, 0.0).states(TIMES[k : k + 1])[0],
                              truth[k])  # fmt: skip
    threaded = _core.Propagator(spec, 2451545.0, 0.0)
    wrong = []

    def ask(first):
        for k in range(200):
            k = (first + k) % len(TIMES)
            if not np.array_equal(threaded.states(TIMES[k : k + 1])[0], truth[k]):
                wrong.append(k)

    crew = [threading.Thread(target=ask, args=(n,)) for n in range(4)]
    for thread in crew:
        thread.start()
    for thread in crew:
        thread.join()
    assert not wrong


def test_velocities_are_derivatives():
    for kind, spec in EXAMPLES.items():
        path = _core.Propagator(spec, 2451545.0, 0.0)
        for t in TIMES:
            around = path.states(t + np.array([-2.0, -1.0, 0.0, 1.0, 2.0]))
            slope = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0 @ around[:, :3]
            assert np.abs(slope - around[2, 3:]).max() < 1e-5, kind


def test_made_once():
    """The same numbers in other dictionaries are the same propagator; other numbers are not."""
    one = motion.propagator(KEPLER, EPOCH)
    same = {**KEPLER, "elements": dict(reversed(KEPLER["elements"].items()))}
    assert motion.propagator(same, EPOCH) is one
    assert motion.propagator({**KEPLER, "gm": np.nextafter(4e14, 0)}, EPOCH) is not one
    assert motion.propagator(KEPLER, Date(2461000.0, 0.5)) is not one


def test_large_tables_are_known_by_their_numbers():
    """Read-only arrays by a digest made once, others anew; equal numbers: the same propagator."""
    table, made = EXAMPLES["table"], []
    for change in (0.0, 0.0, 1e-9):
        states = table["states"].copy()
        states[-1, 0] += change
        states.flags.writeable = False
        made.append({**table, "states": states})
    first = motion.propagator(made[0], EPOCH)
    assert motion.propagator(made[0], EPOCH) is first
    assert motion.propagator(made[1], EPOCH) is first
    assert motion.propagator(made[2], EPOCH) is not first
    changing = {**table, "states": table["states"].copy()}
    before = motion.propagator(changing, EPOCH)
    changing["states"][-1, 0] += 1.0
    assert motion.propagator(changing, EPOCH) is not before
    known = len(motion._digests._known)
    del made, states
    assert len(motion._digests._known) == known - 3


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_a_fork_while_another_thread_looks_up():
    """The child gets locks of its own and keeps nothing of the parent's; its bits are the same."""
    truth = motion.evaluate(nodes(), EPOCH, TIMES).poses["sat"]
    kept = motion.propagator(KEPLER, EPOCH)
    held, done = threading.Event(), threading.Event()

    def hold():
        with motion._propagators._lock:
            held.set()
            done.wait()

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait()
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # ends the child if it waits for the lock
        same = np.array_equal(motion.evaluate(nodes(), EPOCH, TIMES).poses["sat"], truth)
        os._exit(0 if same and motion.propagator(KEPLER, EPOCH) is not kept else 1)
    status = os.waitpid(child, 0)[1]
    done.set()
    thread.join()
    assert os.waitstatus_to_exitcode(status) == 0
    assert motion.propagator(KEPLER, EPOCH) is kept


def test_evaluating_again_allocates_nothing():
    kept = nodes()
    first = motion.evaluate(kept, EPOCH, TIMES)
    before = _core.allocations()
    again = motion.evaluate(kept, EPOCH, TIMES)
    assert _core.allocations() == before
    assert np.array_equal(first.poses["sat"], again.poses["sat"])
    assert np.array_equal(first.velocities_m_s["sat"], again.velocities_m_s["sat"])
    motion.evaluate(nodes(rate_rad_s=1e-3), EPOCH, TIMES)
    assert _core.allocations() > before  # another tree


def test_functions_give_states_and_axes():
    def path(t_s):
        return np.stack([np.full(len(t_s), 1e6), t_s, 0 * t_s, 0 * t_s, 0 * t_s + 1, 0 * t_s], 1)

    def axes(t_s):
        return np.stack([np.cos(t_s), 0 * t_s, 0 * t_s, np.sin(t_s)], 1)

    probe = {"name": "probe", "parent": 1, "motion": path, "rotation": {"frame": axes}}
    found = motion.evaluate([*nodes(), probe], EPOCH, TIMES)
    assert np.array_equal(found.poses["probe"][:, :3],
                          found.poses["sat"][:, :3] + path(TIMES)[:, :3])  # fmt: skip
    assert np.abs(found.poses["probe"][:, 3:] - axes(TIMES)).max() < 1e-15


def test_errors_name_the_node():
    bad = {**KEPLER, "elements": {**KEPLER["elements"], "eccentricity": -1.0}}
    with pytest.raises(ValueError, match="sat: kepler: eccentricity is -1"):
        motion.evaluate([nodes()[0], {**nodes()[1], "motion": bad}], EPOCH, TIMES)
    late = {**nodes()[1], "motion": EXAMPLES["table"]}
    with pytest.raises(ValueError, match=r"node 'sat': 9000 s is outside the table"):
        motion.evaluate([nodes()[0], late], EPOCH, np.array([9000.0]))
    two = {**KEPLER, "elements": {**KEPLER["elements"], "mean_anomaly_rad": 0.0}}
    with pytest.raises(ValueError, match="elements need one of since_periapsis_s, mean"):
        motion.propagator(two, EPOCH)


def test_tables_of_other_shapes_are_refused():
    for states in (np.zeros((300, 4)), np.zeros((299, 3))):
        with pytest.raises(ValueError, match=r"table: states: shape must be \(300, 3\) or"):
            motion.propagator({**EXAMPLES["table"], "states": states}, EPOCH)
