// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: the points of a convex hull.
#pragma once

#include "rigid_body_sim/shape.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// Returns the folder of a package by its name, "" for an unknown one.
using PackageFolders = std::function<std::string(const std::string& package)>;

/// Sets the function that finds the package of "package://NAME/FILE". The core itself knows no packages and
/// refuses such a URL until then. To be called before any thread reads a scene.
void findPackagesBy(PackageFolders folders);

/// The vertices of all meshes of a file, where its nodes place them, m, in the axes of the file. Where the
/// format has a unit of its own (COLLADA), it is converted. Else the numbers are taken as metres.
///
/// `location` is an absolute path, a path relative to `folder` (where that is not ""), or a package URL. The
/// name ends in .obj, .stl, .ply, .gltf, .glb or .dae. Throws InvalidInput with `path` for a file that is not
/// there, that confineFilesTo() excludes, that is larger than 256 MiB, is no sound mesh, or holds no vertices
/// or more than Limits::max_hull_points. The vertices are counted before memory is taken for them. A glTF
/// file may name buffers beside it or in folders below. Nothing else in a file leads to another file. Cost:
/// the whole file is read and parsed.
std::vector<Vec3> readMesh(const std::string& location, const std::string& folder, const std::string& path);

/// The convex hull of the vertices that readMesh() returns, times `scale` (> 0). Its frame P is that of the
/// file. Throws InvalidInput with `path` and the file where readMesh() or makeHull() refuses.
PlacedHull hullOfMesh(const std::string& location, const std::string& folder, double scale,
                      const std::string& path);
/// The convex hull of `points` that readMesh() has returned, times `scale` (> 0). `location` is named in
/// messages only. Throws InvalidInput with `path` and `location` where makeHull() refuses.
PlacedHull hullOfMesh(std::vector<Vec3> points, const std::string& location, double scale,
                      const std::string& path);

}  // namespace rbs
