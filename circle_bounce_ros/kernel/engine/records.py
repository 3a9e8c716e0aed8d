"""What the engine keeps: one record a body, and the world that holds them. All in SI units."""

from __future__ import annotations

from circle_bounce_ros.kernel.impact import NEVER

# What a circle is going to touch; the numbers of the first four are those of the contact log.
CIRCLE, LOCKED, WALL, WALL_END, NOTHING = 0, 1, 2, 3, 4

# The side of its cell that a circle leaves through. EVERYWHERE: look at all cells around.
LEFT, RIGHT, DOWN, UP, EVERYWHERE = 0, 1, 2, 3, 4


class Moving:
    """
    A moving circle between two of its own events, with its plan for the next one.

    It is at `x + vx (t - time)` at time t. `changes` counts its changes of course: a plan that names
    it as a partner is stale once the count has gone on.
    """

    __slots__ = (
        'away', 'cell', 'changes', 'id', 'ix', 'iy', 'kind', 'mass', 'partner', 'partner_changes',
        'radius', 'side', 'time', 'time_of_cell', 'time_of_hit', 'vx', 'vy', 'x', 'y',
    )  # fmt: skip

    def __init__(
        self, id: int, x: float, y: float, vx: float, vy: float, radius: float, mass: float
    ) -> None:
        self.id = id  # in the scene
        self.x = x
        self.y = y
        self.vx = vx
        self.vy = vy
        self.time = 0.0
        self.radius = radius
        self.mass = mass
        self.changes = 0
        # The plan: what it touches next and when; when and through which side it leaves its cell.
        self.time_of_hit = 0.0  # with kind NOTHING: plan afresh then
        self.kind = NOTHING
        self.partner = -1  # index among moving circles, locked circles or walls
        self.partner_changes = 0
        self.time_of_cell = NEVER
        self.side = EVERYWHERE
        # The cell: column and row, and the number of the list that it shares.
        self.ix = 0
        self.iy = 0
        self.cell = 0
        self.away = False  # far outside of everything locked, in no cell


class Locked:
    """A locked circle, or the end of a wall as a circle of radius 0."""

    __slots__ = ('id', 'kind', 'radius', 'x', 'y')

    def __init__(self, kind: int, id: int, x: float, y: float, radius: float) -> None:
        self.kind = kind  # LOCKED or WALL_END
        self.id = id  # of the circle, or number of the wall
        self.x = x
        self.y = y
        self.radius = radius


class Flat:
    """The flat of a wall: where it starts, its unit normal (direction turned left), its length."""

    __slots__ = ('id', 'length', 'nx', 'ny', 'x', 'y')

    def __init__(self, id: int, x: float, y: float, nx: float, ny: float, length: float) -> None:
        self.id = id  # number of the wall
        self.x = x
        self.y = y
        self.nx = nx
        self.ny = ny
        self.length = length


class Grid:
    """
    Square cells without end, and who is in them: see `grid`.

    `home` is the part of the plane in which something locked can be touched; the porch around it is
    where circles are still in cells. Both are (x_min, y_min, x_max, y_max).
    """

    __slots__ = (
        'around', 'bits', 'columns', 'flats', 'locked', 'mask', 'members', 'porch', 'rows', 'width',
        'x0', 'y0',
    )  # fmt: skip

    def __init__(
        self,
        x0: float,
        y0: float,
        width: float,
        columns: int,
        rows: int,
        porch: tuple[float, float, float, float],
    ) -> None:
        self.x0 = x0
        self.y0 = y0
        self.width = width
        self.columns = columns  # of home
        self.rows = rows
        self.porch = porch
        # A cell's number keeps its low bits only. Four cells a side at least: nine differ.
        self.bits = max(2, (columns - 1).bit_length())
        lists = 1 << (self.bits + max(2, (rows - 1).bit_length()))
        self.mask = lists - 1
        self.members: list[list[int]] = [[] for _ in range(lists)]
        self.locked: list[list[int]] = [[] for _ in range(lists)]
        self.flats: list[list[int]] = [[] for _ in range(lists)]
        row = 1 << self.bits
        left, right = [-1 - row, -1, -1 + row], [1 - row, 1, 1 + row]
        down, up = [-1 - row, -row, 1 - row], [-1 + row, row, 1 + row]
        # The cells that come into reach on entering a cell through a side, by side; last all nine.
        self.around = [left, right, down, up, [*left, -row, 0, row, *right]]


class World:
    """Everything that the engine works on."""

    __slots__ = (
        'away', 'collide', 'contacts', 'crowd', 'crowd_ends', 'crowd_span', 'epoch', 'events', 'flats',
        'grid', 'keep_log', 'leaf', 'locked', 'log', 'moving', 'patience', 'span', 'time', 'tree_time',
        'tree_who',
    )  # fmt: skip

    def __init__(
        self,
        moving: list[Moving],
        locked: list[Locked],
        flats: list[Flat],
        grid: Grid,
        collide: bool,
        keep_log: bool,
        span: float,
        crowd_span: float,
        patience: int,
    ) -> None:
        self.moving = moving
        self.locked = locked
        self.flats = flats
        self.grid = grid
        self.collide = collide
        self.away: list[int] = []  # moving circles that are in no cell
        # All times in here count from the epoch: clocks are set back before they grow beyond the span.
        self.epoch = 0.0
        self.span = span
        self.time = 0.0  # of the last event
        self.events = 0
        self.contacts = 0
        self.keep_log = keep_log
        self.log: list[tuple[float, int, int, int, float, float, float, float, float]] = []
        # Contacts without end: more than `patience` of them within `crowd_span`.
        self.crowd_span = crowd_span
        self.crowd_ends = -NEVER
        self.crowd = 0
        self.patience = patience
        # The tournament: leaf + i is circle i's place, 1 the root; see `tournament`.
        self.leaf = 1 << max(0, (len(moving) - 1).bit_length())
        self.tree_time = [NEVER] * (2 * self.leaf)
        self.tree_who = [0] * (2 * self.leaf)
