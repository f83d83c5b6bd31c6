// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: the points of a convex hull.
#pragma once

#include "rigid_body_sim/shape.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// The folder of a package by its name; "" for an unknown one.
using PackageFolders = std::function<std::string(const std::string& package)>;

/// How "package://NAME/FILE" is found from now on. The core itself knows no packages. To be called before any
/// thread reads a scene.
void findPackagesBy(PackageFolders folders);

/// The vertices of all meshes of a file, where its nodes place them; m, in the axes of the file. Where the
/// format has a unit of its own (COLLADA), it is converted; else the numbers are taken as they are.
///
/// `location` is an absolute path, a path relative to `folder` (where that is not ""), or a package URL. The
/// name ends in .obj, .stl, .ply, .gltf, .glb or .dae. Throws InvalidInput with `path` for a file that is not
/// there, that confineFilesTo() excludes, that is larger than 256 MiB, is no sound mesh, or holds no vertices
/// or more than Limits::max_hull_points, which are counted before there is room for them. A glTF file may
/// name buffers beside it or in folders below, and nothing else of a file leads to another.
std::vector<Vec3> readMesh(const std::string& location, const std::string& folder, const std::string& path);

/// The hull of these vertices times `scale`, in the axes P of the file. Throws InvalidInput with `path` and
/// the file as readMesh() and makeHull() do.
PlacedHull hullOfMesh(const std::string& location, const std::string& folder, double scale,
                      const std::string& path);
/// The same for points that readMesh() returned.
PlacedHull hullOfMesh(std::vector<Vec3> points, const std::string& location, double scale,
                      const std::string& path);

}  // namespace rbs
