// SPDX-License-Identifier: BSD-3-Clause
// The formats that are little more than lists of points: OBJ, STL and PLY.
#include "shapes/meshes/formats.h"

#include "rigid_body_sim/scene.h"
#include "shapes/meshes/scanner.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace rbs::meshes {

void countPoints(std::size_t more, std::size_t& count) {
  count += more;
  if (more > Limits::max_hull_points || count > Limits::max_hull_points) {
    throw BadMesh(
        "more than " + std::to_string(Limits::max_hull_points) + " points",
        "at most " + std::to_string(Limits::max_hull_points) + " points, those of repeated meshes included");
  }
}

void limitElements(std::string_view text, std::string_view characters) {
  constexpr std::ptrdiff_t most = 1'000'000;
  const auto count = std::count_if(text.begin(), text.end(),
                                   [&](char c) { return characters.find(c) != std::string_view::npos; });
  if (count > most) throw BadMesh("more than 1000000 elements", "at most 1000000 elements");
}

// --- Wavefront OBJ

namespace {

/// The index of a vertex in "v", "v/vt", "v//vn" or "v/vt/vn", which counts from 1, or from the last one by
/// -1.
std::size_t vertexOf(std::string_view corner, std::size_t vertices) {
  const auto index = Scanner::numberOf<std::int64_t>(corner.substr(0, corner.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  if (index < -count || index == 0 || index > count) {
    throw BadMesh("a face of vertex " + std::to_string(index) + " of " + std::to_string(count),
                  "faces of the vertices above them");
  }
  return static_cast<std::size_t>(index > 0 ? index - 1 : count + index);
}

}  // namespace

Points readObj(std::string_view bytes) {
  Points points;
  std::vector<bool> used;
  bool has_faces = false;
  std::size_t count = 0;
  for (Scanner file(bytes); !file.rest().empty();) {
    Scanner line(file.line());
    const std::string_view key = line.word();
    if (key == "v") {
      countPoints(1, count);
      points.push_back(line.vector());
      used.push_back(false);
    } else if (key == "f") {
      has_faces = true;
      while (!line.atEnd()) used[vertexOf(line.word(), points.size())] = true;
    }
  }
  if (!has_faces) return points;
  Points result;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (used[v]) result.push_back(points[v]);
  return result;
}

// --- STL

namespace {

template <class Number>
Number numberAt(std::string_view bytes, std::size_t at, bool swapped = false) {
  std::array<char, sizeof(Number)> raw;
  std::copy_n(bytes.data() + at, raw.size(), raw.begin());
  if (swapped) std::reverse(raw.begin(), raw.end());
  Number number;
  std::memcpy(&number, raw.data(), raw.size());
  return number;
}

// 80 bytes of text, the number of triangles, and for each a normal, three corners, and two bytes more.
constexpr std::size_t kStlHead = 84, kStlTriangle = 50;

Points readBinaryStl(std::string_view bytes) {
  const std::size_t triangles = numberAt<std::uint32_t>(bytes, kStlHead - 4);
  if ((bytes.size() - kStlHead) / kStlTriangle < triangles) {
    throw BadMesh("shorter than its " + std::to_string(triangles) + " triangles", "a complete file");
  }
  std::size_t count = 0;
  countPoints(3 * triangles, count);
  Points points;
  points.reserve(count);
  for (std::size_t t = 0; t < triangles; ++t) {
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      const std::size_t at = kStlHead + t * kStlTriangle + corner * 3 * sizeof(float);
      points.emplace_back(numberAt<float>(bytes, at), numberAt<float>(bytes, at + 4),
                          numberAt<float>(bytes, at + 8));
    }
  }
  return points;
}

}  // namespace

Points readStl(std::string_view bytes) {
  const bool fits_binary =
      bytes.size() >= kStlHead &&
      bytes.size() == kStlHead + kStlTriangle * std::size_t{numberAt<std::uint32_t>(bytes, kStlHead - 4)};
  const bool is_text = bytes.substr(0, 5) == "solid";
  if (fits_binary || (!is_text && bytes.size() >= kStlHead)) return readBinaryStl(bytes);
  if (!is_text) throw BadMesh("neither text that begins with 'solid' nor a binary file", "an STL file");
  Points points;
  std::size_t count = 0;
  Scanner file(bytes);
  file.line();  // "solid NAME"
  while (!file.atEnd()) {
    if (file.word() != "vertex") continue;
    countPoints(1, count);
    points.push_back(file.vector());
  }
  return points;
}

// --- PLY

namespace {

struct PlyProperty {
  std::string name, type, count_type;  // count_type is empty but for a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHead {
  bool text = false, swapped = false;
  std::vector<PlyElement> elements;
};

[[noreturn]] void refuseHead() {
  throw BadMesh("a bad header", "a PLY file");
}

PlyHead readHead(Scanner& file) {
  PlyHead head;
  if (file.line() != "ply") refuseHead();
  bool has_format = false;
  while (!file.rest().empty()) {
    Scanner line(file.line());
    const std::string_view key = line.word();
    if (key == "end_header" && has_format) return head;
    if (key == "format") {
      const std::string_view format = line.word();
      head.text = format == "ascii";
      head.swapped = format == "binary_big_endian";  // the machine is little-endian
      has_format = head.text || head.swapped || format == "binary_little_endian";
      if (!has_format) refuseHead();
    } else if (key == "element") {
      PlyElement& element = head.elements.emplace_back();
      element.name = line.word();
      element.count = Scanner::numberOf<std::uint64_t>(line.word());
    } else if (key == "property") {
      if (head.elements.empty()) refuseHead();
      PlyProperty property;
      property.type = line.word();
      if (property.type == "list") {
        property.count_type = line.word();
        property.type = line.word();
      }
      property.name = line.word();
      head.elements.back().properties.push_back(property);
    } else if (key != "comment" && key != "obj_info") {
      refuseHead();
    }
  }
  refuseHead();
}

/// The values behind the header, in text or binary.
class PlyValues {
 public:
  PlyValues(const PlyHead& head, std::string_view bytes) : head_(head), words_(bytes), bytes_(bytes) {}

  double next(const std::string& type) {
    if (head_.text) return words_.number();
    if (type == "char" || type == "int8") return take<std::int8_t>();
    if (type == "uchar" || type == "uint8") return take<std::uint8_t>();
    if (type == "short" || type == "int16") return take<std::int16_t>();
    if (type == "ushort" || type == "uint16") return take<std::uint16_t>();
    if (type == "int" || type == "int32") return take<std::int32_t>();
    if (type == "uint" || type == "uint32") return take<std::uint32_t>();
    if (type == "float" || type == "float32") return take<float>();
    if (type == "double" || type == "float64") return take<double>();
    refuseHead();
  }

 private:
  template <class Number>
  Number take() {
    if (bytes_.size() < sizeof(Number)) throw BadMesh("it ends where a number is due", "a complete file");
    const Number number = numberAt<Number>(bytes_, 0, head_.swapped);
    bytes_.remove_prefix(sizeof(Number));
    return number;
  }

  const PlyHead& head_;
  Scanner words_;
  std::string_view bytes_;
};

}  // namespace

Points readPly(std::string_view bytes) {
  Scanner file(bytes);
  const PlyHead head = readHead(file);
  PlyValues values(head, file.rest());
  for (const PlyElement& element : head.elements) {
    const bool wanted = element.name == "vertex";
    if (element.properties.empty()) continue;
    Points points;
    std::size_t count = 0;
    if (wanted) countPoints(element.count, count);
    for (std::uint64_t item = 0; item < element.count; ++item) {
      Vec3 p = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
      for (const PlyProperty& property : element.properties) {
        const bool is_list = !property.count_type.empty();
        double items = is_list ? values.next(property.count_type) : 1.0;
        for (; items >= 1.0; items -= 1.0) {
          const double value = values.next(property.type);
          if (!is_list && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
            p[property.name[0] - 'x'] = value;
        }
      }
      if (wanted) points.push_back(p);
    }
    if (wanted) return points;
  }
  return {};
}

}  // namespace rbs::meshes
