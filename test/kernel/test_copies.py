"""A copy or a pickle of a simulation is an independent one, which goes on to the same bits."""

import copy
import pickle
import subprocess
import sys
from itertools import cycle

import numpy as np
import pytest
from random_scenes import random_scene

from circle_bounce_ros.kernel import Circle, Scene, SceneError, Simulation, Wall
from circle_bounce_ros.kernel.engine import compilation

WAYS = {
    'copy': copy.copy,
    'deepcopy': copy.deepcopy,
    **{
        f'pickle {protocol}': lambda s, protocol=protocol: pickle.loads(pickle.dumps(s, protocol))
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1)
    },
}
MODES = [False] + [True] * compilation.is_available()


def state_of(simulation):
    return (
        simulation.time,
        simulation.contact_count,
        simulation.positions.tobytes(),
        simulation.velocities.tobytes(),
        simulation.record_contacts,
    )


@pytest.mark.parametrize('compiled', MODES)
@pytest.mark.parametrize(
    ('way', 'kind'), list(zip(WAYS, cycle(('mixed', 'pass_through', 'open'))))
)
def test_a_copy_goes_on_to_the_same_bits_and_shares_nothing(kind, way, compiled):
    way, scene = WAYS[way], random_scene(kind, 3)
    undisturbed = Simulation(scene, record_contacts=True, compiled=compiled)
    undisturbed.advance_to(3.0)
    log = undisturbed.drain_contacts().tobytes()
    simulation = Simulation(scene, record_contacts=True, compiled=compiled)
    simulation.advance_to(1.0)
    twin = way(simulation)
    before = state_of(simulation)
    assert state_of(twin) == before
    # One goes on, with contacts in its log that were there before; the other stays where it is.
    twin.advance_to(3.0)
    assert state_of(twin) == state_of(undisturbed)
    assert twin.drain_contacts().tobytes() == log
    assert state_of(simulation) == before
    # And the other way round.
    late = way(simulation)
    simulation.advance_to(3.0)
    assert simulation.drain_contacts().tobytes() == log
    assert state_of(late) == before
    late.record_contacts = False
    assert simulation.record_contacts
    twin.reset()
    assert twin.time == 0.0
    assert state_of(simulation) == state_of(undisturbed)
    for array in (late.ids, late.radii, late.masses):
        with pytest.raises(ValueError, match='read-only'):
            array[0] = 5


def test_a_copy_of_a_log_that_was_full_before_is_whole():
    """A log is kept in blocks; those that are full already belong to the copy too."""
    scene = Scene(
        [Circle((0, 0), (1000.0, 0), radius=0.5), Circle((0, 9), (0, 1), radius=0.1)],
        [Wall((-1, -1), (-1, 1)), Wall((1, -1), (1, 1))],
    )
    simulation = Simulation(scene, record_contacts=True, compiled=False)
    simulation.advance_to(10.0)
    assert simulation.contact_count > 9_000
    twin = copy.copy(simulation)
    assert len(simulation.drain_contacts()) == simulation.contact_count
    assert len(twin.drain_contacts()) == simulation.contact_count


WITHOUT_NUMBA = """
import pickle, sys
sys.modules['numba'] = None
from circle_bounce_ros.kernel.engine import compilation
compilation.is_available = lambda: False
simulation = pickle.load(sys.stdin.buffer)
simulation.advance_to(3.0)
sys.stdout.buffer.write(simulation.positions.tobytes())
"""


@pytest.mark.skipif(not compilation.is_available(), reason='numba is not installed')
def test_a_pickle_of_a_compiled_one_goes_on_where_numba_is_missing():
    simulation = Simulation(random_scene('box', 3), compiled=True)
    simulation.advance_to(1.0)
    done = subprocess.run(
        [sys.executable, '-c', WITHOUT_NUMBA],
        input=pickle.dumps(simulation),
        capture_output=True,
        check=True,
    )
    simulation.advance_to(3.0)
    assert done.stdout == simulation.positions.tobytes()


@pytest.mark.parametrize('way', WAYS.values(), ids=WAYS)
def test_what_a_simulation_is_made_of_can_be_copied_and_pickled(way):
    scene = random_scene('box', 1)
    assert way(scene) == scene
    assert way(scene.circles[0]) == scene.circles[0]
    with pytest.raises(SceneError) as refused:
        Circle((0, 0), radius=-1)
    again = way(refused.value)
    assert (again.place, again.problem) == (refused.value.place, refused.value.problem)
    assert np.array_equal(way(Simulation(scene)).ids, Simulation(scene).ids)
