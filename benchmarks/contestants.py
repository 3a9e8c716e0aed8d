"""
Everybody who takes part, behind one face: a scene goes in, frames go by, positions come out.

Each peer runs with the settings that its own documentation recommends, in the units that it was made for. What it
finds is given back in the units of the scene.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import FRAME
from circle_bounce_ros.kernel import Scene, Simulation

Floats = NDArray[np.float64]


class Contestant(ABC):
    """
    A scene in motion.

    Attributes
    ----------
    name : str
    settings : str
        What somebody needs to know to do the same.

    """

    name: str
    settings: str

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.moving = [circle for circle in scene.circles if not circle.locked]
        self.locked = [circle for circle in scene.circles if circle.locked]
        self.masses = np.array([circle.mass for circle in self.moving])

    @abstractmethod
    def show_frame(self) -> Any:
        """Go on by one frame and read all positions, the way that is fastest here."""

    @abstractmethod
    def positions(self) -> Floats:
        """Return the centres, (n, 2), m."""

    @abstractmethod
    def velocities(self) -> Floats:
        """Return the velocities, (n, 2), m/s."""


class Ours(Contestant):
    """The engine of this project, compiled or plain."""

    name = 'circle_bounce_ros'
    settings = 'as it is'

    def __init__(self, scene: Scene, compiled: bool | None = None) -> None:
        super().__init__(scene)
        self.simulation = Simulation(scene, compiled=compiled)
        self._frames = 0

    def show_frame(self) -> Any:
        self._frames += 1
        self.simulation.advance_to(self._frames * FRAME)
        return self.simulation.positions

    def positions(self) -> Floats:
        return self.simulation.positions

    def velocities(self) -> Floats:
        return self.simulation.velocities


class Pymunk(Contestant):
    """Chipmunk 2D, as pymunk wraps it."""

    # Its own unit is a pixel: "collision_slop: as high as you can without noticeable overlapping", 0.1 by default.
    # Discs of 10 pixels then may overlap by a hundredth of their radius.
    SCALE = 10.0

    def __init__(
        self,
        scene: Scene,
        substeps: int = 1,
        spatial_hash: bool = False,
        batch: bool = False,
    ) -> None:
        import pymunk
        import pymunk.batch

        super().__init__(scene)
        self.name = 'pymunk' if substeps == 1 else f'pymunk, {substeps} substeps'
        self.name += ', read in a batch' if batch else ''
        self.settings = (
            f'pymunk {pymunk.version}: 10 iterations, {substeps} step(s) per frame, elasticity 1, friction 0, '
            f'damping 1, collision_slop 0.01 radii, collision_bias and persistence as they come, '
            f'{"spatial hash" if spatial_hash else "tree"}, '
            f'{"pymunk.batch (experimental)" if batch else "body.position of each"}'
        )
        self._substeps, self._reads_batch = substeps, batch
        space = self._space = pymunk.Space()
        space.iterations = 10
        if spatial_hash:
            # "Setting dim to the average collision shape size", "count to ~10x the number of objects".
            mean = float(np.mean([2.0 * circle.radius for circle in scene.circles]))
            space.use_spatial_hash(mean * self.SCALE, 10 * len(scene.circles))
        shapes: list[Any] = []
        # Shapes of one group do not collide.
        group = pymunk.ShapeFilter(group=0 if scene.moving_circles_collide else 1)
        self._bodies = []
        for circle in self.moving:
            body = pymunk.Body(circle.mass, math.inf)
            body.position = self._scaled(circle.position)
            body.velocity = self._scaled(circle.velocity)
            shape = pymunk.Circle(body, circle.radius * self.SCALE)
            shape.filter = group
            space.add(body, shape)
            self._bodies.append(body)
            shapes.append(shape)
        for circle in self.locked:
            at = self._scaled(circle.position)
            shapes.append(pymunk.Circle(space.static_body, circle.radius * self.SCALE, at))
            space.add(shapes[-1])
        for wall in scene.walls:
            ends = self._scaled(wall.start), self._scaled(wall.end)
            shapes.append(pymunk.Segment(space.static_body, *ends, 0.0))
            space.add(shapes[-1])
        for shape in shapes:
            shape.elasticity = 1.0
        self._batch, self._fields = pymunk.batch, pymunk.batch.BodyFields
        self._buffer = pymunk.batch.Buffer()
        self._ids = np.array([body.id for body in self._bodies], np.uintp)

    def _scaled(self, vector: tuple[float, float]) -> tuple[float, float]:
        return vector[0] * self.SCALE, vector[1] * self.SCALE

    def show_frame(self) -> Any:
        for _ in range(self._substeps):
            self._space.step(FRAME / self._substeps)
        if self._reads_batch:
            return self._read(self._fields.POSITION)
        return [body.position for body in self._bodies]

    def _read(self, field: Any) -> Any:
        self._buffer.clear()
        self._batch.get_space_bodies(self._space, self._fields.BODY_ID | field, self._buffer)
        ids = np.frombuffer(self._buffer.int_buf(), np.uintp)
        return ids, np.frombuffer(self._buffer.float_buf(), np.float64).reshape(-1, 2)

    def _in_order(self, field: Any) -> Floats:
        ids, rows = self._read(field)  # in any order, the space's own static body among them
        order = np.argsort(ids)
        return np.asarray(rows[order[np.searchsorted(ids, self._ids, sorter=order)]] / self.SCALE)

    def positions(self) -> Floats:
        return self._in_order(self._fields.POSITION)

    def velocities(self) -> Floats:
        return self._in_order(self._fields.VELOCITY)


class Box2D(Contestant):
    """
    Box2D 2.3, as its Python package wraps it.

    "Tuned to work well with moving shapes between 0.1 and 10 meters". Below 1 m/s a contact is not elastic, and
    nothing moves further than 2 m in a step: the circles' size is chosen so that both limits matter least.
    """

    name = 'Box2D'
    SMALLEST, LARGEST = 0.1, 1.0  # m
    WANTED = 20.0  # m/s, the typical speed

    def __init__(self, scene: Scene) -> None:
        import Box2D as box2d  # noqa: N813 - so that a class can have the name

        super().__init__(scene)
        speed = float(
            np.sqrt(np.mean([c.velocity[0] ** 2 + c.velocity[1] ** 2 for c in self.moving]))
        )
        smallest = min(circle.radius for circle in self.moving)
        wanted = self.WANTED / speed * smallest
        scale = self._scale = min(max(wanted, self.SMALLEST), self.LARGEST) / smallest
        self.settings = (
            f'Box2D {box2d.__version__}: 8 velocity and 3 position iterations, restitution 1, friction 0, no sleep, '
            f'smallest radius {scale * smallest:.2g} m'
        )
        self._world = world = box2d.b2World(gravity=(0.0, 0.0), doSleep=False)
        category = 1 if scene.moving_circles_collide else 2
        self._bodies = []
        for circle in self.moving:
            body = world.CreateDynamicBody(
                position=(circle.position[0] * scale, circle.position[1] * scale),
                linearVelocity=(circle.velocity[0] * scale, circle.velocity[1] * scale),
                fixedRotation=True,
            )
            body.CreateFixture(
                shape=box2d.b2CircleShape(radius=circle.radius * scale),
                density=circle.mass / (math.pi * (circle.radius * scale) ** 2),
                restitution=1.0,
                friction=0.0,
                categoryBits=category,
                maskBits=0xFFFF if category == 1 else 1,
            )
            self._bodies.append(body)
        for circle in self.locked:
            body = world.CreateStaticBody(
                position=(circle.position[0] * scale, circle.position[1] * scale)
            )
            shape = box2d.b2CircleShape(radius=circle.radius * scale)
            body.CreateFixture(shape=shape, restitution=1.0, friction=0.0)
        for wall in scene.walls:
            ends = [(x * scale, y * scale) for x, y in (wall.start, wall.end)]
            shape = box2d.b2EdgeShape(vertices=ends)
            world.CreateStaticBody().CreateFixture(shape=shape, restitution=1.0, friction=0.0)

    def show_frame(self) -> Any:
        self._world.Step(FRAME, 8, 3)
        return [body.position for body in self._bodies]

    def positions(self) -> Floats:
        return np.array([tuple(body.position) for body in self._bodies]) / self._scale

    def velocities(self) -> Floats:
        return np.array([tuple(body.linearVelocity) for body in self._bodies]) / self._scale


class Billiards(Contestant):
    """python-billiards: exact and event-driven too, each event looked up among all pairs."""

    name = 'python-billiards'

    def __init__(self, scene: Scene) -> None:
        import billiards
        from billiards.obstacles import Disk, InfiniteWall

        super().__init__(scene)
        self.settings = f'python-billiards {billiards.__version__}: as it is'
        obstacles = [Disk(circle.position, circle.radius) for circle in self.locked]
        obstacles += [InfiniteWall(wall.start, wall.end, inside='left') for wall in scene.walls]
        self.billiard = billiards.Billiard(obstacles)
        for circle in self.moving:
            self.billiard.add_ball(circle.position, circle.velocity, circle.radius, circle.mass)
        self._frames = 0

    def show_frame(self) -> Any:
        self._frames += 1
        self.billiard.evolve(self._frames * FRAME)
        return self.billiard.balls_position

    def positions(self) -> Floats:
        return np.array(self.billiard.balls_position)

    def velocities(self) -> Floats:
        return np.array(self.billiard.balls_velocity)
