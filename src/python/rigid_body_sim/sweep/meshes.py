# SPDX-License-Identifier: BSD-3-Clause
"""The mesh files of a sweep: where they are, and a digest of what is in them."""
import hashlib
import os

from rigid_body_sim import InvalidInput, hull_of_mesh

from .tree import split


def from_root(tree, folder):
    """A tree whose meshes have paths from the root: given ones begin at the folder."""
    if isinstance(tree, list):
        return [from_root(entry, folder) for entry in tree]
    if not isinstance(tree, dict):
        return tree
    return {key: os.path.join(folder, value) if key == 'mesh' and isinstance(value, str) and not value.startswith('package://')
            else from_root(value, folder) for key, value in tree.items()}


def from_root_at(path, value, folder):
    """The same for what is put at a path of a tree."""
    key = str(split(path)[-1])
    return from_root({key: value}, folder)[key]


def digests(tree):
    """A digest of the hull of each mesh in a tree that can be read: another mesh in its place makes another sweep."""
    found = {}
    for path in sorted(set(paths_in(tree))):
        try:
            mesh = hull_of_mesh(path)
        except InvalidInput:
            continue  # the scene says so
        arrays = (mesh.hull.vertices, mesh.position, mesh.orientation)
        found[path] = hashlib.sha256(b''.join(array.tobytes() for array in arrays)).hexdigest()
    return found


def paths_in(tree):
    """The paths of all meshes in a tree; a mapping of paths of a scene is one too."""
    for key, entry in tree.items() if isinstance(tree, dict) else ():
        if isinstance(entry, str) and str(key).endswith('mesh'):
            yield entry
    for entry in tree.values() if isinstance(tree, dict) else tree if isinstance(tree, list) else ():
        yield from paths_in(entry)
