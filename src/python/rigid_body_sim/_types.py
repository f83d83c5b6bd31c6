# SPDX-License-Identifier: BSD-3-Clause
"""What the physics answers with: plain tuples with names, which can be pickled. The extension makes them."""
from __future__ import annotations

import inspect
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeVar

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy import float64, uint64
    from numpy.typing import NDArray

    from ._core import ConvexHull

    Vector: TypeAlias = tuple[float, float, float] | list[float] | NDArray[float64]


_T = TypeVar('_T')


def _with_field_docs(cls: type[_T]) -> type[_T]:
    """Gives each field of a named tuple the words that the text of its class has for it."""
    for field, words in re.findall(r'^(\w+): (.*(?:\n +.*)*)', inspect.getdoc(cls) or '', re.MULTILINE):
        getattr(cls, field).__doc__ = ' '.join(words.split())
    return cls


def _compares_arrays(cls: type[_T]) -> type[_T]:
    """Makes two named tuples equal where all their fields are, arrays by shape and numbers (a NaN is equal
    to a NaN). A plain tuple raises ValueError for arrays."""
    def equal(self: tuple[object, ...], other: object) -> bool:
        if type(self) is not type(other):
            return False if isinstance(other, tuple) else NotImplemented
        from numpy import array_equal, ndarray
        return all(array_equal(mine, theirs, equal_nan=True) if isinstance(mine, ndarray) else mine == theirs
                   for mine, theirs in zip(self, other))

    def unequal(self: tuple[object, ...], other: object) -> bool:
        same = equal(self, other)
        return same if same is NotImplemented else not same

    cls.__eq__, cls.__ne__ = equal, unequal
    return cls


def _as_tuple(self: object, field: str) -> None:
    """Makes a tuple of numbers of a list or an array, so that equal ones compare as equal. Other values are reported where they
    are used."""
    value = getattr(self, field)
    if not isinstance(value, (list, tuple)) and type(value).__module__ != 'numpy':
        return
    try:
        numbers = tuple(float(x) for x in value if not isinstance(x, str))
    except (TypeError, ValueError, OverflowError):
        return
    if len(numbers) == len(value):
        object.__setattr__(self, field, numbers)


@_with_field_docs
class Problem(NamedTuple):
    """One thing that is wrong with an input.

    path: where: "bodies[3].material.friction", or "scene.yaml:12: bodies[3].mass"
    value: what was found there; may be empty
    allowed: what is allowed instead
    """
    path: str
    value: str
    allowed: str


class InvalidInput(ValueError):
    """Bad input. It is raised before anything is changed, and holds every problem that was found.

    The text has one line a problem for the first 20 of them.
    """

    def __init__(self, text: str = '', problems: tuple[Problem, ...] = ()) -> None:
        super().__init__(text)
        self.problems = problems

    def __reduce__(self) -> tuple[type[InvalidInput], tuple[str, tuple[Problem, ...]]]:
        return type(self), (str(self), self.problems)


@dataclass(frozen=True)
class Sphere:
    """A ball about the origin of B.

    radius: m, > 0
    """
    radius: float = 0.25


@dataclass(frozen=True)
class Box:
    """A box about the origin of B, edges along the axes of B.

    size: full edge lengths, m, each > 0
    """
    size: Vector = (0.5, 0.5, 0.5)

    def __post_init__(self) -> None:
        _as_tuple(self, 'size')


@dataclass(frozen=True)
class Plane:
    """The half-space z <= 0 of B: a wall or floor without end. Never dynamic."""


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` of a segment on the z axis of B, about its origin.

    radius: m, > 0
    half_length: half the length of the segment, m, >= 0
    """
    radius: float = 0.125
    half_length: float = 0.125


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the z axis and the origin of B.

    radius: m, > 0
    half_length: half the length along z, m, > 0
    """
    radius: float = 0.25
    half_length: float = 0.25


@dataclass(frozen=True)
class Cone:
    """A cone about the z axis of B, with its apex at z = 3/4 of its height and its base at -1/4.

    radius: radius of the base, m, > 0
    height: distance of the apex from the base, m, > 0
    """
    radius: float = 0.25
    height: float = 0.5


if TYPE_CHECKING:
    Shape: TypeAlias = Sphere | Box | Plane | Capsule | Cylinder | Cone | ConvexHull


@dataclass(frozen=True)
class Setting:
    """Solver settings: a quality level, and numbers that override those behind its name (docs/dial.md).

    preset: 'preview', 'interactive', 'accurate' or 'reference'
    divisions: equal solver steps that each step is divided into, 1 to 1000
    sub_steps: of the soft step in each division, 1 to 1000; None: by the preset
    tolerance: residuals at which the exact step stops, 1e-15 to 0.1; None: by the preset
    max_solve_ms: wall time for the exact solves of a step, ms; runs then differ. None: no end
    """
    preset: str = 'interactive'
    divisions: int = 1
    sub_steps: int | None = None
    tolerance: float | None = None
    max_solve_ms: float | None = None


@dataclass(frozen=True)
class Goal:
    """The goal by which a simulator changes the solver settings. Exactly one of the two is given.

    max_error: largest error of the position of any body, m per second simulated
    max_step_ms: longest mean wall time of a step, ms; runs then differ
    """
    max_error: float | None = None
    max_step_ms: float | None = None


@dataclass(frozen=True)
class Air:
    """The air of a scene. Where there is air, drag is simulated.

    density: kg/m³, 1e-6 to 1e9
    """
    density: float = 1.2


@dataclass(frozen=True)
class Wind:
    """The velocity of the air. Needs air.

    velocity: mean velocity in W, m/s, at most 1e4
    gust: standard deviation of each horizontal component, m/s, 0 to 1e4; 0 is steady
    """
    velocity: Vector = (4.0, 0.0, 0.0)
    gust: float = 0.0

    def __post_init__(self) -> None:
        _as_tuple(self, 'velocity')


@dataclass(frozen=True)
class Fluid:
    """Still water, or another fluid, that fills all space below a level.

    density: kg/m³, 1e-6 to 1e9
    level: z of its surface in W, m
    """
    density: float = 1000.0
    level: float = 0.0


@dataclass(frozen=True)
class View:
    """Where a viewer should stand and look. The two points must differ.

    eye: where the viewer stands, in W, m
    target: where the viewer looks, in W, m
    """
    eye: Vector = (8.0, -8.0, 5.0)
    target: Vector = (0.0, 0.0, 0.5)

    def __post_init__(self) -> None:
        _as_tuple(self, 'eye')
        _as_tuple(self, 'target')


@_compares_arrays
@_with_field_docs
class Totals(NamedTuple):
    """Energy and momentum, summed over the dynamic bodies that are not frozen.

    kinetic_energy: J
    potential_energy: energy in the field of gravity, J, zero at the origin of W
    momentum: (3,), in W, kg m/s
    angular_momentum: (3,), about the origin of W, in W, kg m²/s
    """
    kinetic_energy: float
    potential_energy: float
    momentum: NDArray[float64]
    angular_momentum: NDArray[float64]


@_compares_arrays
@_with_field_docs
class BodyDescription(NamedTuple):
    """The properties of a body that change only by an edit, or when the body is frozen.

    id: handle
    name: unique in the world, never empty
    shape: in B
    kind: 'dynamic', 'static' or 'kinematic'
    mass: kg, also of a body that forces do not move; 0 for a plane
    density: kg/m³; 0 for a plane
    inertia: (3,), principal moments about the axes of B, kg m²; 0 for a plane
    friction: Coulomb's coefficient
    restitution: Newton's coefficient
    drag_coefficient: dimensionless
    rolling_resistance: dimensionless
    torsional_resistance: dimensionless
    color: red, green, blue, alpha, each 0 to 1
    group: collision groups that it is in, one a bit
    mask: groups that it may collide with, one a bit
    frozen: Whether its state was not finite or out of range, so that it was put back and stopped. edit_body() with a
        pose or a kind sets it free.
    """
    id: int
    name: str
    shape: Shape
    kind: str
    mass: float
    density: float
    inertia: NDArray[float64]
    friction: float
    restitution: float
    drag_coefficient: float
    rolling_resistance: float
    torsional_resistance: float
    color: tuple[float, float, float, float]
    group: int
    mask: int
    frozen: bool


@_with_field_docs
class StageInfo(NamedTuple):
    """A stage of the step: whether it runs, why, and what it costs.

    name: 'forces.drag'
    active: whether the scene needs it
    reason: why it is or is not needed
    items: number of its items in the last step
    unit: what its items are: 'bodies', or 'body' where there is one; empty: they are not counted
    seconds: wall time in the last step, s
    part_of: name of the stage that it is a part of; empty: it is a stage of the step itself
    """
    name: str
    active: bool
    reason: str
    items: int
    unit: str
    seconds: float
    part_of: str


@_with_field_docs
class StepWarning(NamedTuple):
    """Trouble at run time, with its remedy.

    kind: 'non_finite', 'too_fast', 'impact_budget', 'overlap', 'unsolved', 'solve_budget' or 'missed_contact'
    text: what happened, to which body, and what to do
    """
    kind: str
    text: str


@_with_field_docs
class IslandResiduals(NamedTuple):
    """How well the contacts of one island (dynamic bodies that contacts connect) were solved in the last step.

    Residuals are the worst over all solves, dimensionless: fractions of the speed that the loads add in a division.

    bodies: dynamic bodies
    contacts: contact points, also those that nearly touch
    method: 'soft_step', or the most expensive solver that the exact step took
    iterations: of the exact step's solvers; 0 for the soft step
    signorini: closing speed at closed points, and normal speed at loaded ones
    coulomb: friction beyond the cone, as the speed that it makes
    dissipation: slip that friction does not oppose, or slip where it sticks
    converged: whether the exact solvers reached their tolerance
    deepest_penetration: m, >= 0
    energy_change: of kinetic and potential energy over the division, J
    turn: largest angle that one of its bodies turned by, rad
    """
    bodies: int
    contacts: int
    method: str
    iterations: int
    signorini: float
    coulomb: float
    dissipation: float
    converged: bool
    deepest_penetration: float
    energy_change: float
    turn: float


@_compares_arrays
@_with_field_docs
class RayHit(NamedTuple):
    """Where a ray enters a body. A body that holds the origin is hit there, at distance 0.

    body: handle of the body
    point: (3,), in W, m
    normal: (3,), outward unit normal of the body there, in W
    distance: from the origin of the ray, m, >= 0
    """
    body: int
    point: NDArray[float64]
    normal: NDArray[float64]
    distance: float


@_compares_arrays
@_with_field_docs
class ClosestPoints(NamedTuple):
    """The points at which two bodies a and b are nearest to each other, or overlap most deeply.

    distance: separation, m; negative: penetration depth, by which b must move along the normal to leave a
    normal: (3,), unit, in W, from a to b
    point_a: (3,), on the surface of a, in W, m
    point_b: (3,), on the surface of b, in W, m
    """
    distance: float
    normal: NDArray[float64]
    point_a: NDArray[float64]
    point_b: NDArray[float64]


@_with_field_docs
class Neighbour(NamedTuple):
    """A body near the shape of overlaps().

    body: handle of the body
    distance: separation from the shape, m; negative: penetration depth
    """
    body: int
    distance: float


@_with_field_docs
class Difference(NamedTuple):
    """Deviation of one run from another of the same scene, over the dynamic bodies.

    moved_body: name of the body with the largest distance between the runs; '': no position differs
    distance: between the two centres of mass of that body, m
    turned_body: name of the body with the largest angle between the runs; '': no orientation differs
    angle: between the two orientations of that body, rad
    energy: difference of the total energy, dimensionless: a fraction of the kinetic and the lifting energy
    """
    moved_body: str
    distance: float
    turned_body: str
    angle: float
    energy: float


@_compares_arrays
@_with_field_docs
class PlacedHull(NamedTuple):
    """A convex hull, and the pose of its body frame B in the frame P of the points that it was made of.

    hull: the shape, in B
    position: (3,), of the origin of B in P, m
    orientation: (4,), quaternion [x, y, z, w] that rotates vectors from B to P
    """
    hull: ConvexHull
    position: NDArray[float64]
    orientation: NDArray[float64]


@_compares_arrays
@_with_field_docs
class Rollout(NamedTuple):
    """The runs of rollout().

    states: (scenes, samples, bodies, 13), each body's position (m), orientation [x, y, z, w], velocity (m/s) and angular
        velocity (rad/s), in W; NaN where a scene has fewer bodies than another
    times: (scenes, samples), physics time of each sample, s
    hashes: (scenes,), World.state_hash() at the end of each run
    flags: of each scene the kinds of warnings that its steps gave, in alphabetical order, such as 'non_finite' where a body
        was stopped; empty: none
    """
    states: NDArray[float64]
    times: NDArray[float64]
    hashes: NDArray[uint64]
    flags: tuple[tuple[str, ...], ...]
