// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/mesh_file.h"

#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/quote.h"
#include "shapes/meshes/formats.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace rbs {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 256u << 20;
const std::string kPackageScheme = "package://";

PackageFolders& packageFolders() {
  static PackageFolders folders = [](const std::string&) { return std::string(); };
  return folders;
}

[[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{path, value, allowed}});
}

std::string named(const fs::path& file) {
  return quoted(file.string(), kLongestPath);
}

/// The file, which may be read.
fs::path find(const std::string& location, const std::string& folder, const std::string& path) {
  if (location.find('\0') != std::string::npos) refuse(path, quoted(location), "a path without the byte 0");
  if (location.compare(0, kPackageScheme.size(), kPackageScheme) == 0) {
    const std::string rest = location.substr(kPackageScheme.size());
    const std::size_t slash = rest.find('/');
    if (slash == 0 || slash == std::string::npos) refuse(path, named(location), "package://NAME/FILE");
    const std::string package = packageFolders()(rest.substr(0, slash));
    if (package.empty()) refuse(path, named(location), "a package that can be found");
    const fs::path file = fs::path(package) / rest.substr(slash + 1);
    requireAccess(file.string(), path, package);
    return file;
  }
  fs::path file(location);
  if (!file.is_absolute()) {
    if (location.empty() || folder.empty())
      refuse(path, named(location), "an absolute path or package://NAME/FILE");
    file = fs::path(folder) / file;
  }
  requireAccess(file.string(), path, folder);
  return file;
}

std::string readBytes(const fs::path& file, const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) refuse(path, named(file) + ": no such file", "a mesh file");
  if (!fs::is_regular_file(status)) refuse(path, named(file) + ": not a regular file", "a mesh file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || size > kMostBytes) refuse(path, named(file) + ": too large", "a mesh file of at most 256 MiB");
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) refuse(path, named(file) + ": cannot be read", "a file that may be read");
  return bytes;
}

/// Opens a buffer of a glTF file, which must not lead out of its folder.
meshes::OpenBeside besideOf(const fs::path& file, const std::string& path) {
  return [file, path](const std::string& uri) {
    std::error_code error;
    const fs::path folder = fs::canonical(file.parent_path(), error);
    const fs::path buffer = fs::weakly_canonical(folder / uri, error);
    const auto parted = std::mismatch(folder.begin(), folder.end(), buffer.begin(), buffer.end());
    if (error || uri.find('\0') != std::string::npos || parted.first != folder.end()) {
      throw meshes::BadMesh("the buffer " + quoted(uri),
                            "buffers in the file, beside it, or below its folder");
    }
    return readBytes(buffer, path);
  };
}

std::vector<Vec3> parse(const fs::path& file, const std::string& path) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const std::string bytes = readBytes(file, path);
  if (ending == ".obj") return meshes::readObj(bytes);
  if (ending == ".stl") return meshes::readStl(bytes);
  if (ending == ".ply") return meshes::readPly(bytes);
  if (ending == ".dae") return meshes::readCollada(bytes);
  if (ending == ".gltf" || ending == ".glb") return meshes::readGltf(bytes, besideOf(file, path));
  throw meshes::BadMesh("an unknown format", "a file that ends in .obj, .stl, .ply, .gltf, .glb or .dae");
}

}  // namespace

void findPackagesBy(PackageFolders folders) {
  packageFolders() = std::move(folders);
}

std::vector<Vec3> readMesh(const std::string& location, const std::string& folder, const std::string& path) {
  stopIfInterrupted(path);
  const fs::path file = find(location, folder, path);
  try {
    std::vector<Vec3> points = parse(file, path);
    if (points.empty()) throw meshes::BadMesh("no vertices", "a mesh");
    return points;
  } catch (const meshes::BadMesh& fault) {
    refuse(path, named(file) + ": " + fault.what(), fault.allowed);
  }
}

PlacedHull hullOfMesh(const std::string& location, const std::string& folder, double scale,
                      const std::string& path) {
  return hullOfMesh(readMesh(location, folder, path), location, scale, path);
}

PlacedHull hullOfMesh(std::vector<Vec3> points, const std::string& location, double scale,
                      const std::string& path) {
  for (Vec3& p : points) p *= scale;
  try {
    return makeHull(points, path);
  } catch (const InvalidInput& refusal) {
    const Problem& problem = refusal.problems().front();
    refuse(path, named(location) + ": " + problem.value, problem.allowed);
  }
}

}  // namespace rbs
