"""Make the short animation of the lesson: `python -m docs.figures.animation [--into FOLDER]`."""

from __future__ import annotations

import argparse
from pathlib import Path

from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene

PICTURES = Path(__file__).resolve().parents[1] / 'pictures'

RATE = 25  # frames per second
LENGTH = 6.0  # s
TRAIL = 1.5  # s
GREEN, RED, WALL, BLUE = '#009e73', '#d55e00', '#45535d', '#0072b2'


def animate(scene_name: str) -> FuncAnimation:
    """Return the animation of a scene of one moving circle, named as in config/scenes."""
    scene = load_scene(scene_name)
    simulation = Simulation(scene)
    figure = Figure(figsize=(4.8, 3.7), dpi=100)
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    axes.set_aspect('equal')
    axes.axis('off')
    for wall in scene.walls:
        axes.plot(*zip(wall.start, wall.end, strict=True), color=WALL, linewidth=2)
    for circle in scene.circles:
        if circle.locked:
            axes.add_patch(Circle(circle.position, circle.radius, color=RED))
    (trail,) = axes.plot([], [], color=BLUE, linewidth=1.2)
    (index,) = simulation.ids
    ball = axes.add_patch(Circle((0, 0), scene.circles[index].radius, color=GREEN))
    places: list[tuple[float, float]] = []

    def show(frame: int) -> None:
        simulation.advance_to(frame / RATE)
        x, y = simulation.positions[0].tolist()
        places.append((x, y))
        ball.center = (x, y)
        trail.set_data(*zip(*places[-round(TRAIL * RATE) :], strict=True))

    # Without a first call of its own, time would run back to the second.
    return FuncAnimation(
        figure, show, frames=round(LENGTH * RATE), init_func=list, cache_frame_data=False
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog='docs.figures.animation', description=__doc__)
    parser.add_argument('--into', type=Path, default=PICTURES, metavar='FOLDER')
    into = parser.parse_args().into
    into.mkdir(parents=True, exist_ok=True)
    animate('lesson').save(into / 'lesson.gif', writer=PillowWriter(fps=RATE))


if __name__ == '__main__':
    main()
