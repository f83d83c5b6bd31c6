// SPDX-License-Identifier: BSD-3-Clause
#include "instance_material.h"

#include <OgreHighLevelGpuProgram.h>
#include <OgreHighLevelGpuProgramManager.h>
#include <OgreMaterialManager.h>
#include <OgreTechnique.h>

#include <string>

namespace rbs {
namespace {

const char* const kGroup = "General";  // of resources: that of Ogre which is always there

// Of an instance (instances.h): uv1 position and handle, uv2 quaternion, uv3 size and extra, uv4 colour.
// Of a vertex: uv0 end. Ogre finds only attributes with a declaration of their own. Light is reckoned by
// vertex, since pixels are what takes the time where no graphics card helps.
const char* const kPlace = R"(
attribute vec4 vertex;
attribute vec3 normal;
attribute vec4 uv0;
attribute vec4 uv1;
attribute vec4 uv2;
attribute vec4 uv3;
attribute vec4 uv4;
uniform mat4 worldviewproj_matrix, worldview_matrix, world_matrix;
uniform vec4 ambient, light_positions[4], light_colors[4];
varying vec3 point, picked;
varying vec2 tiles;
varying vec4 color, plain;
varying float extra, handle, depth, far;

vec3 turned(vec4 q, vec3 v) {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

// `up`: the part of n that is upwards in the world of the bodies.
vec3 lightAt(vec3 place, vec3 n, float up) {
  vec3 sum = ambient.rgb * (0.5 + 0.06 * up);
  for (int i = 0; i < 4; ++i) {
    vec3 to_light = normalize(light_positions[i].xyz - light_positions[i].w * place);
    sum += light_colors[i].rgb * max(0.0, dot(n, to_light));
  }
  return sum;
}

// A handle is a whole number below 2^24, which a float holds exactly, but not after it was interpolated.
vec3 bytesOf(float whole) {
  float r = floor(whole / 65536.0), g = floor((whole - 65536.0 * r) / 256.0);
  return vec3(r, g, whole - 65536.0 * r - 256.0 * g) / 255.0;
}

void main() {
  vec3 size = uv3.xyz;
  vec4 here = vec4(turned(uv2, vertex.xyz * size + vec3(0.0, 0.0, uv0.x * uv3.w)) + uv1.xyz, 1.0);
  vec3 n_W = turned(uv2, normalize(normal / size));
  vec3 n = normalize(mat3(world_matrix) * n_W);
  point = vertex.xyz;
  tiles = vertex.xy * size.xy / uv3.w;
  plain = uv4;
  color = vec4(uv4.rgb * lightAt((world_matrix * here).xyz, n, n_W.z), uv4.a);
  extra = uv3.w;
  handle = uv1.w;
  picked = bytesOf(uv1.w);
  depth = -(worldview_matrix * here).z;
  far = size.x;
  gl_Position = worldviewproj_matrix * here;
}
)";

// A surface is marked by two tones, as by the fields of a chessboard, each seam one pixel wide.
const char* const kPatterns[] = {
    R"(
float marked() { return 1.0; }
)",
    R"(
vec3 sides() { return clamp(point / max(fwidth(point), 1e-6), -1.0, 1.0); }
float marked() { vec3 s = sides(); return 0.775 + 0.225 * s.x * s.y * s.z; }
)",
    R"(
vec3 sides() { return clamp(point / max(fwidth(point), 1e-6), -1.0, 1.0); }
float marked() { vec3 s = sides(); return 0.775 + 0.225 * s.x * s.y; }
)",
    // The mean over a pixel is the difference of the integral, a zigzag line.
    R"(
vec2 zigzag(vec2 x) { return 2.0 * abs(fract(0.5 * x) - 0.5); }
float marked() {
  vec2 width = clamp(fwidth(tiles), 1e-3, 1e3);
  vec2 tile = (zigzag(tiles + 0.5 * width) - zigzag(tiles - 0.5 * width)) / width;
  return 0.93 + 0.07 * tile.x * tile.y;
}
)",
    // Edges of a box are darker, unless it is small in the picture.
    R"(
float marked() {
  vec3 a = abs(point);
  float inside = 1.0 - max(min(a.x, a.y), max(min(a.y, a.z), min(a.x, a.z)));  // 0 at an edge
  float pixel = max(fwidth(inside), 1e-6);
  return mix(0.74, 1.0, clamp(max(inside / pixel - 0.5, pixel * 8.0), 0.0, 1.0));
}
)"};

const char* const kVaryings = R"(
varying vec3 point, picked;
varying vec2 tiles;
varying vec4 color, plain;
varying float extra, handle, depth, far;
)";

const char* const kLit = R"(
void main() { gl_FragColor = vec4(color.rgb * marked(), color.a); }
)";

const char* const kGround = R"(
void main() { gl_FragColor = vec4(color.rgb * marked(), color.a * (1.0 - smoothstep(0.3, 1.0, depth / far))); }
)";

const char* const kPlain = R"(
void main() { gl_FragColor = plain; }
)";

// Full inside, and fading out towards the rim; `extra` is the share that is full.
const char* const kSpot = R"(
void main() {
  gl_FragColor = vec4(plain.rgb, plain.a * (1.0 - smoothstep(extra, 1.0, length(point.xy))));
}
)";

const char* const kPick = R"(
void main() {
  if (handle < 0.5) discard;
  gl_FragColor = vec4(picked, 1.0);
}
)";

const char* const kBlack = R"(
void main() {
  if (handle < 0.5) discard;
  gl_FragColor = vec4(0.0, 0.0, 0.0, 1.0);
}
)";

// As RViz reads it: the depth over the distance of the far plane, in three bytes, the lowest in red.
const char* const kDepth = R"(
uniform float far_clip_distance;
void main() {
  if (handle < 0.5) discard;
  vec3 parts = fract(depth / far_clip_distance * vec3(65536.0, 256.0, 1.0));
  parts.yz -= parts.xy / 256.0;
  gl_FragColor = vec4(parts.zyx, 1.0);
}
)";

const char* const kNothing = R"(
void main() { discard; }
)";

void makeProgram(const std::string& name, Ogre::GpuProgramType type, const std::string& source) {
  auto& manager = Ogre::HighLevelGpuProgramManager::getSingleton();
  if (manager.getByName(name, kGroup)) return;
  manager.createProgram(name, kGroup, "glsl", type)->setSource("#version 120\n" + source);
}

void setVertexProgram(Ogre::Pass& pass) {
  using Params = Ogre::GpuProgramParameters;
  const std::string name = "rigid_body_sim/instance";
  makeProgram(name, Ogre::GPT_VERTEX_PROGRAM, kPlace);
  pass.setVertexProgram(name);
  const auto params = pass.getVertexProgramParameters();
  params->setIgnoreMissingParams(true);  // a program need not use all
  params->setNamedAutoConstant("worldviewproj_matrix", Params::ACT_WORLDVIEWPROJ_MATRIX);
  params->setNamedAutoConstant("worldview_matrix", Params::ACT_WORLDVIEW_MATRIX);
  params->setNamedAutoConstant("world_matrix", Params::ACT_WORLD_MATRIX);
  params->setNamedAutoConstant("ambient", Params::ACT_AMBIENT_LIGHT_COLOUR);
  params->setNamedAutoConstant("light_positions", Params::ACT_LIGHT_POSITION_ARRAY, 4);
  params->setNamedAutoConstant("light_colors", Params::ACT_LIGHT_DIFFUSE_COLOUR_ARRAY, 4);
}

void setFragmentProgram(Ogre::Pass& pass, const std::string& name, const std::string& source) {
  using Params = Ogre::GpuProgramParameters;
  makeProgram("rigid_body_sim/" + name, Ogre::GPT_FRAGMENT_PROGRAM, kVaryings + source);
  pass.setFragmentProgram("rigid_body_sim/" + name);
  const auto params = pass.getFragmentProgramParameters();
  params->setIgnoreMissingParams(true);
  params->setNamedAutoConstant("far_clip_distance", Params::ACT_FAR_CLIP_DISTANCE);
}

void setColors(Ogre::Pass& pass, Look look, Pattern pattern) {
  const auto number = static_cast<std::size_t>(pattern);
  const std::string marked = kPatterns[number], suffix = "_" + std::to_string(number);
  switch (look) {
    case Look::Solid:
    case Look::SeeThrough:
    case Look::OnTop:
      return setFragmentProgram(pass, "lit" + suffix, marked + kLit);
    case Look::Ground:
      return setFragmentProgram(pass, "ground" + suffix, marked + kGround);
    case Look::Plain:
    case Look::Outline:
      return setFragmentProgram(pass, "plain", kPlain);
    case Look::Shadow:
      return setFragmentProgram(pass, "spot", kSpot);
  }
}

void addPicking(Ogre::Material& material, const std::string& scheme, const std::string& name,
                const char* source) {
  Ogre::Technique* const technique = material.createTechnique();
  technique->setSchemeName(scheme);
  Ogre::Pass* const pass = technique->createPass();
  pass->setLightingEnabled(false);
  pass->setSceneBlending(Ogre::SBT_REPLACE);
  pass->setCullingMode(Ogre::CULL_NONE);
  setVertexProgram(*pass);
  setFragmentProgram(*pass, name, source);
}

bool isPicked(Look look) {
  return look == Look::Solid || look == Look::SeeThrough || look == Look::Ground;
}

}  // namespace

Ogre::MaterialPtr instanceMaterial(Look look, Pattern pattern) {
  const std::string name = "rigid_body_sim/instances_" + std::to_string(static_cast<int>(look)) + "_" +
                           std::to_string(static_cast<int>(pattern));
  Ogre::MaterialManager& manager = Ogre::MaterialManager::getSingleton();
  if (Ogre::MaterialPtr made = manager.getByName(name, kGroup)) return made;
  Ogre::MaterialPtr material = manager.create(name, kGroup);
  Ogre::Pass& pass = *material->getTechnique(0)->getPass(0);
  setVertexProgram(pass);
  setColors(pass, look, pattern);
  if (look == Look::Outline) pass.setCullingMode(Ogre::CULL_ANTICLOCKWISE);
  if (look != Look::Solid && look != Look::Outline && look != Look::OnTop) {
    pass.setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
    pass.setDepthWriteEnabled(look == Look::Ground);
  }
  if (look == Look::OnTop) pass.setDepthCheckEnabled(false);
  if (look == Look::Shadow) pass.setDepthBias(1.0f, 1.0f);
  addPicking(*material, "Pick", isPicked(look) ? "pick" : "nothing", isPicked(look) ? kPick : kNothing);
  addPicking(*material, "Pick1", isPicked(look) ? "black" : "nothing", isPicked(look) ? kBlack : kNothing);
  addPicking(*material, "Depth", isPicked(look) ? "depth" : "nothing", isPicked(look) ? kDepth : kNothing);
  return material;
}

}  // namespace rbs
