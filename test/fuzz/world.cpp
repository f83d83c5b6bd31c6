// SPDX-License-Identifier: BSD-3-Clause
// Sequences of edits, questions and steps, read from the bytes of the input.
#include "targets.h"

#include "rigid_body_sim/queries.h"
#include "rigid_body_sim/shape.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace rbs::fuzz {
namespace {

constexpr std::size_t kMostBodies = 12;
constexpr int kMostSteps = 40;
constexpr int kMostCalls = 200;

/// Values out of bytes; zeros when they are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }
  std::uint8_t byte() {
    if (empty()) return 0;
    --size_;
    return *data_++;
  }
  bool chance() { return byte() & 1; }
  std::uint64_t word() {
    std::uint64_t bits = 0;
    for (int k = 0; k < 8; ++k) bits = bits << 8 | byte();
    return bits;
  }

  /// Mostly a plain number from -8 to 8, else a notorious one or any bits.
  double number() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    static constexpr std::array notorious{0.0,
                                          -0.0,
                                          1e-300,
                                          -1e-300,
                                          1e-9,
                                          1e-6,
                                          1e-3,
                                          1e3,
                                          1e6,
                                          -1e6,
                                          1e9,
                                          -1e9,
                                          1e18,
                                          1e300,
                                          inf,
                                          -inf,
                                          std::numeric_limits<double>::quiet_NaN()};
    const std::uint8_t kind = byte();
    if (kind < 192) return static_cast<std::int8_t>(byte()) / 16.0;
    if (kind < 250) return notorious[byte() % notorious.size()];
    const std::uint64_t bits = word();
    double any;
    std::memcpy(&any, &bits, sizeof any);
    return any;
  }
  std::optional<double> maybe() { return chance() ? std::optional<double>(number()) : std::nullopt; }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Pose pose() {
    Pose pose;
    pose.p_WB = vector();
    if (chance()) pose.q_WB.coeffs() << vector(), number();
    return pose;
  }
  Twist twist() {
    const Vec3 v = vector();
    return {v, vector()};
  }
  Shape shape() {
    switch (byte() % 8) {
      case 0:
        return Sphere{number()};
      case 1:
        return Box{vector()};
      case 2:
        return Plane{};
      case 3: {
        const double radius = number();
        return Capsule{radius, number()};
      }
      case 4: {
        const double radius = number();
        return Cylinder{radius, number()};
      }
      case 5: {
        const double radius = number();
        return Cone{radius, number()};
      }
      case 6: {
        std::vector<Vec3> points(byte() % 12);
        for (Vec3& p : points) p = vector();
        return makeHull(points, "points").hull;
      }
      default:
        return Box{};
    }
  }
  BodyKind kind() { return std::array{BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic}[byte() % 3]; }
  BodyDef body() {
    BodyDef def;
    if (chance()) def.name = std::string(1, static_cast<char>(byte()));
    def.shape = shape();
    def.pose = pose();
    if (chance()) def.twist = twist();
    if (chance()) def.kind = kind();
    def.mass = maybe();
    if (!def.mass) def.density = maybe();
    if (chance()) def.material.friction = number();
    if (chance()) def.material.restitution = number();
    if (chance()) def.material.rolling_resistance = number();
    if (chance()) def.material.torsional_resistance = number();
    if (chance()) def.material.drag_coefficient = number();
    if (chance()) def.group = byte(), def.mask = byte();
    return def;
  }
  BodyEdit edit() {
    BodyEdit edit;
    if (chance()) edit.shape = shape();
    if (chance()) edit.pose = pose();
    if (chance()) edit.twist = twist();
    if (chance()) edit.kind = kind();
    edit.mass = maybe();
    edit.density = maybe();
    edit.friction = maybe();
    edit.restitution = maybe();
    edit.drag_coefficient = maybe();
    edit.rolling_resistance = maybe();
    edit.torsional_resistance = maybe();
    return edit;
  }
  Setting setting() {
    Setting setting = kFidelities[byte() % kFidelities.size()];
    if (chance()) setting.divisions = byte() % 5;
    if (chance()) setting.sub_steps = byte() % 20;
    setting.tolerance = maybe();
    return setting;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A body of the world, or one that is not in it any more.
BodyId someBody(Input& input, const World& world) {
  const Snapshot snapshot = world.snapshot();
  const std::size_t k = input.byte();
  return k < 250 && !snapshot.states.empty() ? snapshot.states[k % snapshot.states.size()].id : BodyId{k};
}

void ask(Input& input, const World& world) {
  const Snapshot snapshot = world.snapshot();
  switch (input.byte() % 3) {
    case 0: {
      Ray ray;
      ray.origin_W = input.vector();
      ray.direction_W = input.vector();
      for (const RayHit& hit : castRayThrough(snapshot, ray))
        require(std::isfinite(hit.distance), "a ray goes astray");
      return;
    }
    case 1: {
      const BodyId a = someBody(input, world), b = someBody(input, world);
      require(std::isfinite(closestPoints(snapshot, a, b).distance), "a distance is not finite");
      return;
    }
    default: {
      const Shape shape = input.shape();
      const Pose pose = input.pose();
      for (const Neighbour& neighbour : overlaps(snapshot, shape, pose, input.number()))
        require(std::isfinite(neighbour.distance), "a distance is not finite");
    }
  }
}

void editBodies(Input& input, World& world) {
  switch (input.byte() % 6) {
    case 0: {
      std::vector<BodyDef> bodies(1 + input.byte() % 3);
      for (BodyDef& body : bodies) body = input.body();
      if (world.snapshot().states.size() + bodies.size() <= kMostBodies) world.addBodies(bodies);
      return;
    }
    case 1:
      return world.removeBody(someBody(input, world));
    case 2:
      return world.clear();
    case 3: {
      BodyDef body;
      body.shape = input.shape();
      body.pose.q_WB = input.pose().q_WB;
      body.kind = BodyKind::Static;
      if (!validate(body, "body").empty()) return;
      require(world.freePlace(body.shape, body.pose.q_WB).allFinite(), "a free place is nowhere");
      return;
    }
    default: {
      const BodyId id = someBody(input, world);
      return world.editBody(id, input.edit());
    }
  }
}

void push(Input& input, World& world) {
  const BodyId id = someBody(input, world);
  switch (input.byte() % 5) {
    case 0: {
      const Vec3 impulse = input.vector();
      return world.applyImpulse(id, impulse, input.vector());
    }
    case 1: {
      const Vec3 force = input.vector(), torque = input.vector(), point = input.vector();
      return world.applyWrench(id, force, torque, point, input.number());
    }
    case 2: {
      Grab grab;
      grab.p_B = input.vector();
      grab.p_W = input.vector();
      if (input.chance()) grab.frequency = input.number();
      if (input.chance()) grab.max_acceleration = input.number();
      return world.grab(id, grab);
    }
    case 3:
      return world.hold(id, input.pose());
    default:
      return world.release(id);
  }
}

void editSurroundings(Input& input, World& world) {
  switch (input.byte() % 7) {
    case 0:
      return world.setGravity(input.vector());
    case 1:
      return world.setAir(input.chance() ? std::optional<Air>(Air{input.number()}) : std::nullopt);
    case 2: {
      if (!input.chance()) return world.setWind(std::nullopt);
      const Vec3 velocity = input.vector();
      return world.setWind(Wind{velocity, input.number()});
    }
    case 3: {
      if (!input.chance()) return world.setFluid(std::nullopt);
      const double density = input.number();
      return world.setFluid(Fluid{density, input.number()});
    }
    case 4: {
      const std::optional<double> error = input.maybe();
      return world.setGoal(Goal{error, input.maybe()});
    }
    case 5: {
      EffectOverrides effects;
      for (int k = input.byte() % 4; k > 0; --k)
        effects[kEffects[input.byte() % kEffects.size()]] = input.chance();
      return world.setEffects(effects);
    }
    default:
      return world.setFidelity(input.setting());
  }
}

}  // namespace

void world(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  SceneDef scene;
  scene.fidelity = kFidelities[input.byte() % kFidelities.size()];
  scene.bodies.resize(1);
  scene.bodies[0].name = "floor";
  scene.bodies[0].shape = Plane{};
  scene.bodies[0].kind = BodyKind::Static;
  World world(scene);
  int steps = 0;
  for (int call = 0; call < kMostCalls && !input.empty(); ++call) {
    const std::uint64_t before = world.stateHash();
    const std::uint8_t choice = input.byte() % 8;
    try {
      if (choice < 3) editBodies(input, world);
      if (choice == 3) push(input, world);
      if (choice == 4) editSurroundings(input, world);
      if (choice == 5) ask(input, world);
      if (choice == 5) require(world.stateHash() == before, "a question changed the state");
    } catch (const InvalidInput&) {
      require(world.stateHash() == before, "a refused edit changed the state");
    }
    if (choice < 6 || steps == kMostSteps) continue;
    ++steps;
    World copy(world);
    world.step();
    requireFinite(world);
    if (choice < 7) continue;
    copy.step();
    require(copy.stateHash() == world.stateHash(), "a copy has another future");
  }
}

}  // namespace rbs::fuzz
