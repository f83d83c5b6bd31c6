// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0 (ISO/IEC 12113): JSON that describes a scene, and buffers of numbers, in one file (GLB) or
// several.
#include "shapes/meshes/formats.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

namespace rbs::meshes {
namespace {

using Json = nlohmann::json;

constexpr int kFloat = 5126;  // the component type of positions
constexpr int kMostPrimitives = 100'000, kDeepest = 256;
constexpr std::size_t kMostBytes = 256u << 20;

[[noreturn]] void refuse(const std::string& fault) {
  throw BadMesh(fault, "a sound glTF 2.0 file");
}

std::uint32_t wordAt(std::string_view bytes, std::size_t at) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::size_t sizeOf(const Json& object, const char* key, std::size_t otherwise) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > UINT32_MAX)
    refuse(std::string("a bad ") + key);
  return found->get<std::size_t>();
}

/// The object that `key` of `from` names in one of the lists of the file.
const Json& lookUp(const Json& root, const char* list, const Json& from, const char* key) {
  const std::size_t index = sizeOf(from, key, SIZE_MAX);
  const auto found = root.find(list);
  if (found == root.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object()) {
    refuse(std::string("no ") + key + " in " + list);
  }
  return (*found)[index];
}

std::string fromBase64(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) refuse("bad base64");
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xffffffu;
    if ((have += 6) < 8) continue;
    have -= 8;
    bytes += static_cast<char>(bits >> have & 0xffu);
  }
  return bytes;
}

class Gltf {
 public:
  Gltf(std::string_view bytes, const OpenBeside& beside) : beside_(beside) {
    std::string_view text = bytes;
    if (bytes.substr(0, 4) == "glTF") text = openContainer(bytes);
    limitElements(text, ",[{");
    root_ = Json::parse(text, nullptr, false);
    if (!root_.is_object()) refuse("no JSON object");
  }

  Points read() {
    const Json first{{"scene", 0u}};
    const Json& scene =
        lookUp(root_, "scenes", root_.contains("scene") ? std::as_const(root_) : first, "scene");
    visited_.assign(root_.contains("nodes") ? root_["nodes"].size() : 0, false);
    visitAll(scene, "nodes", Eigen::Affine3d::Identity());
    Points points;
    points.reserve(count_);
    for (const Instance& instance : instances_) expand(instance, points);
    return points;
  }

 private:
  /// An accessor of positions, and where a node puts them.
  struct Instance {
    const Json* accessor;
    Eigen::Affine3d X_WN;
  };

  /// Of a binary file: 12 bytes of head, then chunks with their length and kind: the JSON, and a buffer.
  std::string_view openContainer(std::string_view bytes) {
    constexpr std::size_t head = 12, chunk_head = 8;
    if (bytes.size() < head + chunk_head || wordAt(bytes, 4) != 2) refuse("not version 2");
    const auto chunkAt = [&](std::size_t at) {
      const std::size_t length = wordAt(bytes, at);
      if (bytes.size() - at - chunk_head < length) refuse("shorter than it says");
      return bytes.substr(at + chunk_head, length);
    };
    const std::string_view text = chunkAt(head);
    const std::size_t next = head + chunk_head + text.size();
    if (bytes.size() - next >= chunk_head) binary_ = chunkAt(next);
    return text;
  }

  // A node has one parent at most, so what is visited twice is no tree.
  void visitAll(const Json& parent, const char* key, const Eigen::Affine3d& X_WP) {
    const auto list = parent.find(key);
    if (list == parent.end()) return;
    if (!list->is_array()) refuse(std::string("bad ") + key);
    for (const Json& index : *list) {
      const Json& node = lookUp(root_, "nodes", Json{{"node", index}}, "node");
      if (visited_[index.get<std::size_t>()]) refuse("a node with two parents");
      visited_[index.get<std::size_t>()] = true;
      if (++depth_ > kDeepest) refuse("nodes nested more than 256 deep");
      visit(node, X_WP * placeOf(node));
      --depth_;
    }
  }

  void visit(const Json& node, const Eigen::Affine3d& X_WN) {
    if (node.contains("mesh")) {
      const Json& mesh = lookUp(root_, "meshes", node, "mesh");
      if (!mesh.contains("primitives") || !mesh["primitives"].is_array()) refuse("a mesh without primitives");
      for (const Json& primitive : mesh["primitives"]) {
        if (++primitives_ > kMostPrimitives) {
          throw BadMesh("more than 100000 placed primitives",
                        "at most 100000, those of repeated meshes included");
        }
        if (!primitive.is_object() || !primitive.contains("attributes") ||
            !primitive["attributes"].is_object())
          refuse("a primitive without attributes");
        if (!primitive["attributes"].contains("POSITION")) continue;
        const Json& accessor = lookUp(root_, "accessors", primitive["attributes"], "POSITION");
        countPoints(sizeOf(accessor, "count", 0), count_);
        instances_.push_back({&accessor, X_WN});
      }
    }
    visitAll(node, "children", X_WN);
  }

  static std::vector<double> numbersOf(const Json& node, const char* key, std::vector<double> otherwise) {
    const auto list = node.find(key);
    if (list == node.end()) return otherwise;
    if (!list->is_array() || list->size() != otherwise.size()) refuse(std::string("a bad ") + key);
    for (std::size_t k = 0; k < otherwise.size(); ++k) {
      if (!(*list)[k].is_number()) refuse(std::string("a bad ") + key);
      otherwise[k] = (*list)[k].get<double>();
    }
    return otherwise;
  }

  static Eigen::Affine3d placeOf(const Json& node) {
    const std::vector<double> none(16, 0.0);
    if (node.contains("matrix")) {  // column by column
      const std::vector<double> m = numbersOf(node, "matrix", none);
      Eigen::Affine3d X;
      X.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
      return X;
    }
    const auto t = numbersOf(node, "translation", {0, 0, 0}), q = numbersOf(node, "rotation", {0, 0, 0, 1}),
               s = numbersOf(node, "scale", {1, 1, 1});
    return Eigen::Translation3d(t[0], t[1], t[2]) * Quat(q[3], q[0], q[1], q[2]) *
           Eigen::Scaling(s[0], s[1], s[2]);
  }

  void expand(const Instance& instance, Points& points) {
    const Json& accessor = *instance.accessor;
    if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
      throw BadMesh("compressed or sparse positions", "positions in a buffer");
    }
    if (sizeOf(accessor, "componentType", 0) != kFloat || accessor.value("type", Json()) != "VEC3")
      throw BadMesh("positions that are not three floats", "positions of type VEC3 and component type 5126");
    const Json& view = lookUp(root_, "bufferViews", accessor, "bufferView");
    const std::string_view bytes = bufferOf(view);
    const std::size_t item = 3 * sizeof(float), count = sizeOf(accessor, "count", 0);
    const std::size_t stride = std::max<std::size_t>(1, sizeOf(view, "byteStride", item));
    const std::size_t begin = sizeOf(view, "byteOffset", 0) + sizeOf(accessor, "byteOffset", 0);
    if (count > 0 && begin + (count - 1) * stride + item > bytes.size())
      refuse("a buffer shorter than its points");
    for (std::size_t k = 0; k < count; ++k) {
      std::array<float, 3> p;
      std::memcpy(p.data(), bytes.data() + begin + k * stride, item);
      points.push_back(instance.X_WN * Vec3(p[0], p[1], p[2]));
    }
  }

  std::string_view bufferOf(const Json& view) {
    const Json& buffer = lookUp(root_, "buffers", view, "buffer");
    if (!buffer.contains("uri")) return binary_;
    const auto [known, is_new] = opened_.try_emplace(&buffer);
    if (!is_new) return known->second;
    if (!buffer["uri"].is_string()) refuse("a bad uri");
    const std::string uri = buffer["uri"].get<std::string>();
    const std::size_t data = uri.compare(0, 5, "data:") == 0 ? uri.find(";base64,") : std::string::npos;
    known->second =
        data != std::string::npos ? fromBase64(std::string_view(uri).substr(data + 8)) : beside_(uri);
    opened_bytes_ += known->second.size();
    if (opened_bytes_ > kMostBytes) throw BadMesh("buffers of more than 256 MiB", "at most 256 MiB together");
    return known->second;
  }

  const OpenBeside& beside_;
  Json root_;
  std::string_view binary_;
  std::map<const Json*, std::string> opened_;
  std::vector<bool> visited_;
  std::vector<Instance> instances_;
  std::size_t count_ = 0, opened_bytes_ = 0;
  int primitives_ = 0, depth_ = 0;
};

}  // namespace

Points readGltf(std::string_view bytes, const OpenBeside& beside) {
  try {
    return Gltf(bytes, beside).read();
  } catch (const Json::exception&) {
    refuse("a value of another kind than the format has");
  }
}

}  // namespace rbs::meshes
