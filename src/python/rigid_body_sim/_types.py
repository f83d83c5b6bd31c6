# SPDX-License-Identifier: BSD-3-Clause
"""What the physics answers with: plain tuples with names, which can be pickled. The extension makes them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy import float64, uint64
    from numpy.typing import NDArray

    from ._core import ConvexHull

    Vector: TypeAlias = tuple[float, float, float] | list[float] | NDArray[float64]


class Problem(NamedTuple):
    """One thing that is wrong with an input."""
    path: str  #: where: "bodies[3].material.friction", or "scene.yaml:12: bodies[3].mass"
    value: str  #: what was found there; may be empty
    allowed: str  #: what is allowed instead


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
    """A ball about the origin of B."""
    radius: float = 0.25  #: m, > 0


@dataclass(frozen=True)
class Box:
    """A box about the origin of B, edges along the axes of B."""
    size: Vector = (0.5, 0.5, 0.5)  #: full edge lengths, m, each > 0


@dataclass(frozen=True)
class Plane:
    """The half-space z <= 0 of B: a wall or floor without end. Never dynamic."""


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` of a segment on the z axis of B, about its origin."""
    radius: float = 0.125  #: m, > 0
    half_length: float = 0.125  #: half the length of the segment, m, >= 0


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the z axis and the origin of B."""
    radius: float = 0.25  #: m, > 0
    half_length: float = 0.25  #: half the length along z, m, > 0


@dataclass(frozen=True)
class Cone:
    """A cone about the z axis of B, with its apex at z = 3/4 of its height and its base at -1/4."""
    radius: float = 0.25  #: radius of the base, m, > 0
    height: float = 0.5  #: distance of the apex from the base, m, > 0


if TYPE_CHECKING:
    Shape: TypeAlias = Sphere | Box | Plane | Capsule | Cylinder | Cone | ConvexHull


@dataclass(frozen=True)
class Setting:
    """Solver settings: a quality level, and numbers that override those behind its name (docs/dial.md)."""
    preset: str = 'interactive'  #: 'preview', 'interactive', 'accurate' or 'reference'
    divisions: int = 1  #: equal solver steps that each step is divided into, 1 to 1000
    sub_steps: int | None = None  #: of the soft step in each division, 1 to 1000; None: by the preset
    tolerance: float | None = None  #: residuals at which the exact step stops, 1e-15 to 0.1; None: by the preset
    max_solve_ms: float | None = None  #: wall time for the exact solves of a step, ms; runs then differ. None: no end


@dataclass(frozen=True)
class Goal:
    """The goal by which a simulator changes the solver settings. Exactly one of the two is given."""
    max_error: float | None = None  #: largest error of the position of any body, m per second simulated
    max_step_ms: float | None = None  #: longest mean wall time of a step, ms; runs then differ


@dataclass(frozen=True)
class Air:
    """The air of a scene. Where there is air, drag is simulated."""
    density: float = 1.2  #: kg/m³, 1e-6 to 1e9


@dataclass(frozen=True)
class Wind:
    """The velocity of the air. Needs air."""
    velocity: Vector = (4.0, 0.0, 0.0)  #: mean velocity in W, m/s, at most 1e4
    gust: float = 0.0  #: standard deviation of each horizontal component, m/s, 0 to 1e4; 0 is steady


@dataclass(frozen=True)
class Fluid:
    """Still water, or another fluid, that fills all space below a level."""
    density: float = 1000.0  #: kg/m³, 1e-6 to 1e9
    level: float = 0.0  #: z of its surface in W, m


@dataclass(frozen=True)
class View:
    """Where a viewer should stand and look. The two points must differ."""
    eye: Vector = (8.0, -8.0, 5.0)  #: where the viewer stands, in W, m
    target: Vector = (0.0, 0.0, 0.5)  #: where the viewer looks, in W, m


class Totals(NamedTuple):
    """Energy and momentum, summed over the dynamic bodies that are not frozen."""
    kinetic_energy: float  #: J
    potential_energy: float  #: energy in the field of gravity, J, zero at the origin of W
    momentum: NDArray[float64]  #: (3,), in W, kg m/s
    angular_momentum: NDArray[float64]  #: (3,), about the origin of W, in W, kg m²/s


class BodyDescription(NamedTuple):
    """The properties of a body that change only by an edit, or when the body is frozen."""
    id: int  #: handle
    name: str  #: unique in the world, never empty
    shape: Shape  #: in B
    kind: str  #: 'dynamic', 'static' or 'kinematic'
    mass: float  #: kg, also of a body that forces do not move; 0 for a plane
    density: float  #: kg/m³; 0 for a plane
    inertia: NDArray[float64]  #: (3,), principal moments about the axes of B, kg m²; 0 for a plane
    friction: float  #: Coulomb's coefficient
    restitution: float  #: Newton's coefficient
    drag_coefficient: float  #: dimensionless
    rolling_resistance: float  #: dimensionless
    torsional_resistance: float  #: dimensionless
    color: tuple[float, float, float, float]  #: red, green, blue, alpha, each 0 to 1
    group: int  #: collision groups that it is in, one a bit
    mask: int  #: groups that it may collide with, one a bit
    #: Whether its state was not finite or out of range, so that it was put back and stopped. edit_body() with a pose or
    #: a kind sets it free.
    frozen: bool


class StageInfo(NamedTuple):
    """A stage of the step: whether it runs, why, and what it costs."""
    name: str  #: 'forces.drag'
    active: bool  #: whether the scene needs it
    reason: str  #: why it is or is not needed
    items: int  #: number of its items in the last step
    unit: str  #: what its items are: 'bodies', or 'body' where there is one; empty: they are not counted
    seconds: float  #: wall time in the last step, s
    part_of: str  #: name of the stage that it is a part of; empty: it is a stage of the step itself


class StepWarning(NamedTuple):
    """Trouble at run time, with its remedy."""
    kind: str  #: 'non_finite', 'too_fast', 'impact_budget', 'overlap', 'unsolved', 'solve_budget' or 'missed_contact'
    text: str  #: what happened, to which body, and what to do


class IslandResiduals(NamedTuple):
    """How well the contacts of one island (dynamic bodies that contacts connect) were solved in the last step.

    Residuals are the worst over all solves, dimensionless: fractions of the speed that the loads add in a division.
    """
    bodies: int  #: dynamic bodies
    contacts: int  #: contact points, also those that nearly touch
    method: str  #: 'soft_step', or the most expensive solver that the exact step took
    iterations: int  #: of the exact step's solvers; 0 for the soft step
    signorini: float  #: closing speed at closed points, and normal speed at loaded ones
    coulomb: float  #: friction beyond the cone, as the speed that it makes
    dissipation: float  #: slip that friction does not oppose, or slip where it sticks
    converged: bool  #: whether the exact solvers reached their tolerance
    deepest_penetration: float  #: m, >= 0
    energy_change: float  #: of kinetic and potential energy over the division, J
    turn: float  #: largest angle that one of its bodies turned by, rad


class RayHit(NamedTuple):
    """Where a ray enters a body. A body that holds the origin is hit there, at distance 0."""
    body: int  #: handle of the body
    point: NDArray[float64]  #: (3,), in W, m
    normal: NDArray[float64]  #: (3,), outward unit normal of the body there, in W
    distance: float  #: from the origin of the ray, m, >= 0


class ClosestPoints(NamedTuple):
    """The points at which two bodies a and b are nearest to each other, or overlap most deeply."""
    distance: float  #: separation, m; negative: penetration depth, by which b must move along the normal to leave a
    normal: NDArray[float64]  #: (3,), unit, in W, from a to b
    point_a: NDArray[float64]  #: (3,), on the surface of a, in W, m
    point_b: NDArray[float64]  #: (3,), on the surface of b, in W, m


class Neighbour(NamedTuple):
    """A body near the shape of overlaps()."""
    body: int  #: handle of the body
    distance: float  #: separation from the shape, m; negative: penetration depth


class Difference(NamedTuple):
    """Deviation of one run from another of the same scene, over the dynamic bodies."""
    moved_body: str  #: name of the body with the largest distance between the runs; '': no position differs
    distance: float  #: between the two centres of mass of that body, m
    turned_body: str  #: name of the body with the largest angle between the runs; '': no orientation differs
    angle: float  #: between the two orientations of that body, rad
    energy: float  #: difference of the total energy, dimensionless: a fraction of the kinetic and the lifting energy


class PlacedHull(NamedTuple):
    """A convex hull, and the pose of its body frame B in the frame P of the points that it was made of."""
    hull: ConvexHull  #: the shape, in B
    position: NDArray[float64]  #: (3,), of the origin of B in P, m
    orientation: NDArray[float64]  #: (4,), quaternion [x, y, z, w] that rotates vectors from B to P


class Rollout(NamedTuple):
    """The runs of rollout()."""
    #: (scenes, samples, bodies, 13), each body's position (m), orientation [x, y, z, w], velocity (m/s) and angular
    #: velocity (rad/s), in W; NaN where a scene has fewer bodies than another
    states: NDArray[float64]
    times: NDArray[float64]  #: (scenes, samples), physics time of each sample, s
    hashes: NDArray[uint64]  #: (scenes,), World.state_hash() at the end of each run
