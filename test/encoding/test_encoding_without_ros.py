"""Encoding needs no ROS."""

import subprocess
import sys

USE_ALL = """
import sys

REFUSED = ('rclpy', 'rosidl', 'rpyutils', 'ament_index_python')


def of_ros(name):
    return name.split('.')[0].endswith(('_msgs', '_interfaces')) or name.startswith(REFUSED)


class NoRos:
    def find_spec(self, name, path=None, target=None):
        if of_ros(name):
            raise AssertionError(name + ' was imported')


sys.meta_path.insert(0, NoRos())

from circle_bounce_ros.encoding import *
from circle_bounce_ros.kernel import Circle, Scene, Simulation

simulation = Simulation(Scene([Circle((0, 0), (1, 0), radius=1)]))
positions, velocities = simulation.positions, simulation.velocities
PoseStampedEncoder('world').encode(1, positions[0])
TwistStampedEncoder('world').encode(1, velocities[0])
PoseArrayEncoder('world', 1).encode(1, positions)
BodiesEncoder('world', simulation.ids, simulation.radii, simulation.masses).encode(1, positions, velocities)
ContactsEncoder('world').encode(1, simulation.drain_contacts())
TimeReferenceEncoder('world', 'scene').encode(1, 2)
ClockEncoder().encode(1)
MovingMarkersEncoder('world', simulation.radii).encode(1, positions, clear=True)
encode_static_markers('world', 1, simulation.scene)
print([name for name in sys.modules if of_ros(name)])
"""


def test_every_encoder_works_where_ros_cannot_be_imported():
    done = subprocess.run([sys.executable, '-c', USE_ALL], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, '[]\n', '')
