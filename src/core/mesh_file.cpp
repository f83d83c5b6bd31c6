// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <filesystem>

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

fs::path find(const std::string& location, const std::string& folder, const std::string& path) {
  if (location.compare(0, kPackageScheme.size(), kPackageScheme) == 0) {
    const std::string rest = location.substr(kPackageScheme.size());
    const std::size_t slash = rest.find('/');
    if (slash == 0 || slash == std::string::npos) refuse(path, "'" + location + "'", "package://NAME/FILE");
    const std::string package = packageFolders()(rest.substr(0, slash));
    if (package.empty()) refuse(path, "'" + location + "'", "a package that can be found");
    return fs::path(package) / rest.substr(slash + 1);
  }
  const fs::path file(location);
  if (file.is_absolute()) return file;
  if (location.empty() || folder.empty()) {
    refuse(path, "'" + location + "'", "an absolute path or package://NAME/FILE");
  }
  return fs::path(folder) / file;
}

void checkFile(const fs::path& file, const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const std::string name = "'" + file.string() + "'";
  if (!fs::exists(status)) refuse(path, name + ": no such file", "a mesh file");
  if (!fs::is_regular_file(status)) refuse(path, name + ": not a regular file", "a mesh file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || size > kMostBytes) refuse(path, name + ": too large", "a mesh file of at most 256 MiB");
}

void addVertices(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent,
                 std::vector<Vec3>& vertices) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = transform * mesh.mVertices[v];
      vertices.emplace_back(p.x, p.y, p.z);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    addVertices(scene, *node.mChildren[c], transform, vertices);
}

}  // namespace

void findPackagesBy(PackageFolders folders) {
  packageFolders() = std::move(folders);
}

std::vector<Vec3> readMesh(const std::string& location, const std::string& folder, const std::string& path) {
  const fs::path file = find(location, folder, path);
  checkFile(file, path);
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse(path, "'" + file.string() + "': " + importer.GetErrorString(), "a mesh file that assimp can read");
  }
  std::vector<Vec3> vertices;
  addVertices(*scene, *scene->mRootNode, aiMatrix4x4(), vertices);
  if (vertices.empty()) refuse(path, "'" + file.string() + "': no vertices", "a mesh");
  return vertices;
}

PlacedHull hullOfMesh(const std::string& location, const std::string& folder, double scale,
                      const std::string& path) {
  std::vector<Vec3> points = readMesh(location, folder, path);
  for (Vec3& p : points) p *= scale;
  try {
    return makeHull(points, path);
  } catch (const InvalidInput& refusal) {
    const Problem& problem = refusal.problems().front();
    refuse(path, "'" + location + "': " + problem.value, problem.allowed);
  }
}

}  // namespace rbs
