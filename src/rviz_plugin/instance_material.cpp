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
// Of a vertex: uv0 end and pattern. Ogre finds only attributes with a declaration of their own.
const char* const kPlace = R"(#version 120
attribute vec4 vertex;
attribute vec3 normal;
attribute vec4 uv0;
attribute vec4 uv1;
attribute vec4 uv2;
attribute vec4 uv3;
attribute vec4 uv4;
uniform mat4 worldviewproj_matrix, worldview_matrix, world_matrix;
varying vec3 point, size, direction, place;
varying vec4 color;
varying float pattern, extra, handle, depth;

vec3 turned(vec4 q, vec3 v) {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

void main() {
  point = vertex.xyz;
  size = uv3.xyz;
  extra = uv3.w;
  pattern = uv0.y;
  color = uv4;
  handle = uv1.w;
  vec3 local = vertex.xyz * size + vec3(0.0, 0.0, uv0.x * extra);
  vec4 here = vec4(turned(uv2, local) + uv1.xyz, 1.0);
  direction = mat3(world_matrix) * turned(uv2, normalize(normal / size));
  place = (world_matrix * here).xyz;
  depth = -(worldview_matrix * here).z;
  gl_Position = worldviewproj_matrix * here;
}
)";

// A surface is marked by two tones, as by the fields of a chessboard, each seam one pixel wide. The mean of a
// chessboard over a pixel is the difference of its integral, a zigzag line.
const char* const kLit = R"(#version 120
uniform vec4 ambient, light_positions[4], light_colors[4], eye;
varying vec3 point, size, direction, place;
varying vec4 color;
varying float pattern, extra;

float sideOf(float x) {
  return clamp(x / max(fwidth(x), 1e-6), -1.0, 1.0);
}

float zigzag(float x) {
  return 2.0 * abs(fract(0.5 * x) - 0.5);
}

float tile(float x) {
  float width = clamp(fwidth(x), 1e-3, 1e3);
  return (zigzag(x + 0.5 * width) - zigzag(x - 0.5 * width)) / width;
}

float marked() {
  const float light = 0.775, apart = 0.225;
  if (pattern < 0.5) return 1.0;
  if (pattern < 1.5) return light + apart * sideOf(point.x) * sideOf(point.y) * sideOf(point.z);
  if (pattern < 2.5) return light + apart * sideOf(point.x) * sideOf(point.y);
  if (pattern < 3.5) return 0.93 + 0.07 * tile(point.x * size.x / extra) * tile(point.y * size.y / extra);
  vec3 a = abs(point);
  float inside = 1.0 - max(min(a.x, a.y), max(min(a.y, a.z), min(a.x, a.z)));  // 0 at an edge
  float pixel = max(fwidth(inside), 1e-6);
  return mix(0.74, 1.0, clamp(max(inside / pixel - 0.5, pixel * 8.0), 0.0, 1.0));
}

void main() {
  vec3 n = normalize(direction);
  vec3 sum = ambient.rgb * (0.5 + 0.06 * n.z);
  for (int i = 0; i < 4; ++i) {
    vec3 to_light = normalize(light_positions[i].xyz - light_positions[i].w * place);
    sum += light_colors[i].rgb * max(0.0, dot(n, to_light));
  }
  float near = FADES ? 1.0 - smoothstep(0.3, 1.0, length(place - eye.xyz) / size.x) : 1.0;
  gl_FragColor = vec4(color.rgb * sum * marked(), color.a * near);
}
)";

const char* const kPlain = R"(#version 120
varying vec4 color;
void main() { gl_FragColor = color; }
)";

// Full inside, and fading out towards the rim; `extra` is the share that is full.
const char* const kSpot = R"(#version 120
varying vec3 point;
varying vec4 color;
varying float extra;
void main() {
  vec2 p = point.xy * point.xy;
  float out_by = sqrt(sqrt(dot(p, p)));
  gl_FragColor = vec4(color.rgb, color.a * (1.0 - smoothstep(extra, 1.0, out_by)));
}
)";

// The handle is a whole number below 2^24, which a float holds exactly.
const char* const kPick = R"(#version 120
varying float handle;
void main() {
  float h = floor(handle + 0.5);
  if (h < 0.5) discard;
  float r = floor(h / 65536.0), g = floor((h - 65536.0 * r) / 256.0), b = h - 65536.0 * r - 256.0 * g;
  gl_FragColor = vec4(vec3(r, g, b) / 255.0, 1.0);
}
)";

const char* const kBlack = R"(#version 120
varying float handle;
void main() {
  if (handle < 0.5) discard;
  gl_FragColor = vec4(0.0, 0.0, 0.0, 1.0);
}
)";

// As RViz reads it: the depth over the distance of the far plane, in three bytes, the lowest in red.
const char* const kDepth = R"(#version 120
uniform float far_clip_distance;
varying float handle, depth;
void main() {
  if (handle < 0.5) discard;
  vec3 parts = fract(depth / far_clip_distance * vec3(65536.0, 256.0, 1.0));
  parts.yz -= parts.xy / 256.0;
  gl_FragColor = vec4(parts.zyx, 1.0);
}
)";

const char* const kNothing = R"(#version 120
void main() { discard; }
)";

void makeProgram(const std::string& name, Ogre::GpuProgramType type, const std::string& source) {
  auto& manager = Ogre::HighLevelGpuProgramManager::getSingleton();
  if (manager.getByName(name, kGroup)) return;
  manager.createProgram(name, kGroup, "glsl", type)->setSource(source);
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
}

void setFragmentProgram(Ogre::Pass& pass, const std::string& name, const std::string& source) {
  using Params = Ogre::GpuProgramParameters;
  makeProgram("rigid_body_sim/" + name, Ogre::GPT_FRAGMENT_PROGRAM, source);
  pass.setFragmentProgram("rigid_body_sim/" + name);
  const auto params = pass.getFragmentProgramParameters();
  params->setIgnoreMissingParams(true);
  params->setNamedAutoConstant("ambient", Params::ACT_AMBIENT_LIGHT_COLOUR);
  params->setNamedAutoConstant("light_positions", Params::ACT_LIGHT_POSITION_ARRAY, 4);
  params->setNamedAutoConstant("light_colors", Params::ACT_LIGHT_DIFFUSE_COLOUR_ARRAY, 4);
  params->setNamedAutoConstant("eye", Params::ACT_CAMERA_POSITION);
  params->setNamedAutoConstant("far_clip_distance", Params::ACT_FAR_CLIP_DISTANCE);
}

std::string litSource(bool fades) {
  const std::string version = "#version 120\n", flag = fades ? "true" : "false";
  return version + "const bool FADES = " + flag + ";\n" + std::string(kLit).substr(version.size());
}

void setColors(Ogre::Pass& pass, Look look) {
  switch (look) {
    case Look::Solid:
    case Look::SeeThrough:
    case Look::OnTop:
      return setFragmentProgram(pass, "lit", litSource(false));
    case Look::Ground:
      return setFragmentProgram(pass, "ground", litSource(true));
    case Look::Plain:
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

Ogre::MaterialPtr instanceMaterial(Look look) {
  const std::string name = "rigid_body_sim/instances_" + std::to_string(static_cast<int>(look));
  Ogre::MaterialManager& manager = Ogre::MaterialManager::getSingleton();
  if (Ogre::MaterialPtr made = manager.getByName(name, kGroup)) return made;
  Ogre::MaterialPtr material = manager.create(name, kGroup);
  Ogre::Pass& pass = *material->getTechnique(0)->getPass(0);
  setVertexProgram(pass);
  setColors(pass, look);
  if (look != Look::Solid && look != Look::OnTop) {
    pass.setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
    pass.setDepthWriteEnabled(look == Look::Plain || look == Look::Ground);
  }
  if (look == Look::OnTop) pass.setDepthCheckEnabled(false);
  if (look == Look::Shadow) pass.setDepthBias(4.0f, 4.0f);
  addPicking(*material, "Pick", isPicked(look) ? "pick" : "nothing", isPicked(look) ? kPick : kNothing);
  addPicking(*material, "Pick1", isPicked(look) ? "black" : "nothing", isPicked(look) ? kBlack : kNothing);
  addPicking(*material, "Depth", isPicked(look) ? "depth" : "nothing", isPicked(look) ? kDepth : kNothing);
  return material;
}

}  // namespace rbs
