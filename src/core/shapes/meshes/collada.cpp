// SPDX-License-Identifier: BSD-3-Clause
// COLLADA 1.4 and 1.5: geometries, and a tree of nodes that places them. Lengths are converted to m; the
// upward axis is left as it is, as RViz and Gazebo do.
#include "shapes/meshes/formats.h"
#include "shapes/meshes/scanner.h"

#include <tinyxml2.h>

#include <cmath>
#include <unordered_map>

namespace rbs::meshes {
namespace {

using Element = tinyxml2::XMLElement;

constexpr int kDeepest = 64;
constexpr std::size_t kMostVisits = 1'000'000, kMostWords = 100'000'000;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

[[noreturn]] void refuse(const std::string& fault) {
  throw BadMesh(fault, "a sound COLLADA file");
}

std::string_view textOf(const Element* element) {
  const char* text = element ? element->GetText() : nullptr;
  return text ? text : "";
}

const Element* childOf(const Element* parent, const char* name) {
  return parent ? parent->FirstChildElement(name) : nullptr;
}

class Collada {
 public:
  explicit Collada(std::string_view bytes) {
    limitElements(bytes, "<");
    if (document_.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) refuse("not well-formed XML");
    root_ = document_.RootElement();
    if (!root_ || std::string_view(root_->Name()) != "COLLADA") refuse("no COLLADA element");
    index(root_);
  }

  Points read() {
    const Element* instance = childOf(childOf(root_, "scene"), "instance_visual_scene");
    const Element* scene =
        instance ? target(instance, "url") : childOf(childOf(root_, "library_visual_scenes"), "visual_scene");
    if (!scene) refuse("no scene");
    Eigen::Affine3d X = Eigen::Affine3d::Identity();
    if (const Element* unit = childOf(childOf(root_, "asset"), "unit"))
      X = Eigen::Scaling(unit->DoubleAttribute("meter", 1.0));
    visitChildren(scene, X, 0);
    Points points;
    points.reserve(count_);
    for (const Instance& placed : instances_) expand(placed, points);
    return points;
  }

 private:
  /// The positions of a geometry: a list of numbers, and how it is cut.
  struct Positions {
    std::string_view numbers;
    std::size_t count, stride, offset;
  };
  struct Instance {
    Positions positions;
    Eigen::Affine3d X_WN;
  };

  void index(const Element* element) {  // tinyxml2 refuses elements nested more than 500 deep
    if (const char* id = element->Attribute("id")) by_id_.emplace(id, element);
    for (const Element* child = element->FirstChildElement(); child; child = child->NextSiblingElement())
      index(child);
  }

  const Element* target(const Element* element, const char* attribute) const {
    const char* url = element->Attribute(attribute);
    const auto found = url && url[0] == '#' ? by_id_.find(url + 1) : by_id_.end();
    if (found == by_id_.end()) refuse(std::string("no element of a ") + attribute);
    return found->second;
  }

  void visitChildren(const Element* parent, const Eigen::Affine3d& X_WP, int depth) {
    if (depth > kDeepest) refuse("nodes nested more than " + std::to_string(kDeepest) + " deep");
    for (const Element* e = parent->FirstChildElement(); e; e = e->NextSiblingElement()) {
      // A node that is placed many times is visited as often, and so are those that it places.
      if (++visits_ > kMostVisits) throw BadMesh("more than 1000000 placed elements", "at most 1000000");
      const std::string_view name = e->Name();
      if (name == "node") visitNode(e, X_WP, depth + 1);
      if (name == "instance_node") visitNode(target(e, "url"), X_WP, depth + 1);
      if (name == "instance_controller") throw BadMesh("a skinned geometry", "geometries that nodes place");
      if (name == "instance_geometry") place(target(e, "url"), X_WP);
    }
  }

  void visitNode(const Element* node, const Eigen::Affine3d& X_WP, int depth) {
    Eigen::Affine3d X = X_WP;
    for (const Element* e = node->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      Scanner numbers(textOf(e));
      if (name == "translate") X.translate(numbers.vector());
      if (name == "scale") X.scale(numbers.vector());
      if (name == "rotate") {
        const Vec3 axis = numbers.vector();
        if (axis.norm() > 0.0) X.rotate(Eigen::AngleAxisd(numbers.number() * kDegree, axis.normalized()));
      }
      if (name == "matrix") {
        Eigen::Affine3d M;
        for (int k = 0; k < 16; ++k) M.matrix()(k / 4, k % 4) = numbers.number();
        X = X * M;
      }
      if (name == "skew" || name == "lookat")
        throw BadMesh("a <skew> or <lookat>", "nodes moved, turned and scaled");
    }
    visitChildren(node, X, depth);
  }

  void place(const Element* geometry, const Eigen::Affine3d& X_WN) {
    const Element* mesh = childOf(geometry, "mesh");
    if (!mesh) throw BadMesh("a geometry that is no <mesh>", "meshes");
    const Positions positions = positionsOf(mesh);
    countPoints(positions.count, count_);
    words_ += positions.offset + positions.count * positions.stride;
    if (words_ > kMostWords) throw BadMesh("more than 100000000 numbers to read", "at most 100000000");
    instances_.push_back({positions, X_WN});
  }

  Positions positionsOf(const Element* mesh) const {
    const Element* input = childOf(childOf(mesh, "vertices"), "input");
    while (input && !input->Attribute("semantic", "POSITION")) input = input->NextSiblingElement("input");
    if (!input) refuse("a mesh without positions");
    const Element* source = target(input, "source");
    const Element* accessor = childOf(childOf(source, "technique_common"), "accessor");
    if (!accessor) refuse("positions without an accessor");
    const auto attribute = [&](const char* name, unsigned otherwise) {
      const char* text = accessor->Attribute(name);
      return text ? Scanner::numberOf<std::uint32_t>(text) : otherwise;
    };
    const Positions positions{textOf(childOf(source, "float_array")), attribute("count", 0),
                              attribute("stride", 3), attribute("offset", 0)};
    if (positions.stride < 3) throw BadMesh("positions in a plane", "positions of x, y and z");
    // Each number takes two characters or more, so the count is no more than what is there.
    if (positions.count > 0 &&
        (positions.count - 1) * positions.stride + 3 + positions.offset > positions.numbers.size() / 2 + 1) {
      refuse("fewer positions than it says");
    }
    return positions;
  }

  static void expand(const Instance& placed, Points& points) {
    Scanner numbers(placed.positions.numbers);
    for (std::size_t k = 0; k < placed.positions.offset; ++k) numbers.word();
    for (std::size_t k = 0; k < placed.positions.count; ++k) {
      points.push_back(placed.X_WN * numbers.vector());
      if (k + 1 == placed.positions.count) break;
      for (std::size_t more = 3; more < placed.positions.stride; ++more) numbers.word();
    }
  }

  tinyxml2::XMLDocument document_;
  const Element* root_ = nullptr;
  std::unordered_map<std::string, const Element*> by_id_;
  std::vector<Instance> instances_;
  std::size_t count_ = 0, visits_ = 0, words_ = 0;
};

}  // namespace

Points readCollada(std::string_view bytes) {
  return Collada(bytes).read();
}

}  // namespace rbs::meshes
