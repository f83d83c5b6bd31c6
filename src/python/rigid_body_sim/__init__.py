# SPDX-License-Identifier: BSD-3-Clause
"""The rigid-body simulator: its physics for Python, beside the ROS messages (`.msg`) and services (`.srv`).

    import rigid_body_sim as rbs
    world = rbs.World(rbs.Scene.load('ball_hits_wall'))
    world.step(60)
    print(world.time, world.names, world.positions)

The physics needs NumPy and no ROS. It is loaded when one of its names is first used, so the messages can be imported
without it. Units are SI (m, kg, s, rad). The world frame W is right-handed with z up. Quaternions are [x, y, z, w].
`__version__` is the version of the package, as text.
"""
import importlib

from ._version import __version__

_VALUES = (
    'Air', 'BodyDescription', 'Box', 'Capsule', 'ClosestPoints', 'Cone', 'Cylinder', 'Difference', 'Fluid', 'Goal', 'InvalidInput',
    'IslandResiduals', 'Neighbour', 'PlacedHull', 'Plane', 'Problem', 'RayHit', 'Rollout', 'Setting', 'Sphere', 'StageInfo',
    'StepWarning', 'Totals', 'View', 'Wind')
_PHYSICS = (
    'Body', 'ConvexHull', 'Scene', 'Snapshot', 'StepReport', 'World', 'catalogue', 'hull_of_mesh', 'make_hull', 'rollout')
__all__ = [*_VALUES, *_PHYSICS]


def _physics():
    try:
        importlib.import_module('numpy')
        return importlib.import_module('._core', __name__)
    except ImportError as error:
        raise ImportError('the physics of %s for Python cannot be loaded: %s. It needs the Debian packages pybind11-dev, where '
                          'the package is built, and python3-numpy' % (__name__, error)) from error


def __getattr__(name):
    if name not in __all__:
        raise AttributeError("module '%s' has no attribute '%s'" % (__name__, name))
    module = _physics() if name in _PHYSICS else importlib.import_module('._types', __name__)
    value = globals()[name] = getattr(module, name)
    return value


def __dir__():
    return sorted({*globals(), *__all__})
