# SPDX-License-Identifier: BSD-3-Clause
from ._core import (
    Body as Body, ConvexHull as ConvexHull, Scene as Scene, Snapshot as Snapshot, StepReport as StepReport, World as World,
    catalogue as catalogue, hull_of_mesh as hull_of_mesh, make_hull as make_hull, rollout as rollout)
from ._types import (
    Air as Air, BodyDescription as BodyDescription, Box as Box, Capsule as Capsule, ClosestPoints as ClosestPoints, Cone as Cone,
    Cylinder as Cylinder, Difference as Difference, Fluid as Fluid, Goal as Goal, InvalidInput as InvalidInput,
    IslandResiduals as IslandResiduals, Neighbour as Neighbour, PlacedHull as PlacedHull, Plane as Plane, Problem as Problem,
    RayHit as RayHit, Rollout as Rollout, Setting as Setting, Sphere as Sphere, StageInfo as StageInfo,
    StepWarning as StepWarning, Totals as Totals, View as View, Wind as Wind)

__all__ = [
    'Body', 'ConvexHull', 'Scene', 'Snapshot', 'StepReport', 'World', 'catalogue', 'hull_of_mesh', 'make_hull', 'rollout', 'Air',
    'BodyDescription', 'Box', 'Capsule', 'ClosestPoints', 'Cone', 'Cylinder', 'Difference', 'Fluid', 'Goal', 'InvalidInput',
    'IslandResiduals', 'Neighbour', 'PlacedHull', 'Plane', 'Problem', 'RayHit', 'Rollout', 'Setting', 'Sphere', 'StageInfo',
    'StepWarning', 'Totals', 'View', 'Wind']

__version__: str

def __dir__() -> list[str]: ...
