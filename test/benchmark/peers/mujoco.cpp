// SPDX-License-Identifier: BSD-3-Clause
// MuJoCo behind the seam. It has no restitution and no contact without softness.
#include "engine.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rbs::peers {
namespace {

std::string numbers(std::initializer_list<double> values) {
  std::ostringstream text;
  text.precision(17);
  for (double value : values) text << value << ' ';
  return text.str();
}
std::string numbers(const Vec3& v) {
  return numbers({v.x(), v.y(), v.z()});
}

std::string shapeText(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return "type='sphere' size='" + numbers({sphere->radius}) + "'";
  if (const auto* box = std::get_if<Box>(&shape)) return "type='box' size='" + numbers(0.5 * box->size) + "'";
  if (std::holds_alternative<Plane>(shape)) return "type='plane' size='0 0 1'";
  throw Unsupported("the MuJoCo adapter has no " + shapeName(shape));
}

// Of a pair MuJoCo takes the larger coefficient, we take the geometric mean: so pairs are written out.
std::string pairsText(const SceneDef& scene) {
  std::string text;
  const std::size_t count = scene.bodies.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const BodyDef &a = scene.bodies[i], &b = scene.bodies[j];
      if (a.kind != BodyKind::Dynamic && b.kind != BodyKind::Dynamic) continue;
      const double mu = std::sqrt(a.material.friction * b.material.friction);
      text += "<pair geom1='" + a.name + "' geom2='" + b.name + "' condim='" + (mu > 0 ? "3" : "1") +
              "' friction='" + numbers({std::max(mu, 1e-5), std::max(mu, 1e-5), 0.005, 1e-4, 1e-4}) + "'/>";
    }
  return text;
}

std::string modelText(const SceneDef& scene, bool better) {
  std::string text =
      "<mujoco><compiler angle='radian' boundmass='0'/><size njmax='800' nconmax='150'/><option timestep='" +
      numbers({scene.step}) + "' gravity='" + numbers(scene.gravity) + "' " +
      (better ? "integrator='RK4' cone='elliptic' tolerance='1e-14' iterations='200'" : "") +
      "/><default><geom contype='0' conaffinity='0'/></default><worldbody>";
  for (const BodyDef& def : scene.bodies) {
    const Quat& q = def.pose.q_WB;
    const std::string place =
        "pos='" + numbers(def.pose.p_WB) + "' quat='" + numbers({q.w(), q.x(), q.y(), q.z()}) + "'";
    const std::string geom = "<geom name='" + def.name + "' " + shapeText(def.shape);
    if (def.kind != BodyKind::Dynamic) {
      text += geom + " " + place + "/>";
      continue;
    }
    text += "<body " + place + "><freejoint/><inertial pos='0 0 0' mass='" + numbers({massOf(def)}) +
            "' diaginertia='" + numbers(massOf(def) * momentsPerMass(def.shape)) + "'/>" + geom + "/></body>";
  }
  return text + "</worldbody><contact>" + pairsText(scene) + "</contact></mujoco>";
}

mjModel* load(const SceneDef& scene, bool better) {
  const std::string text = modelText(scene, better);
  mjVFS files;
  mj_defaultVFS(&files);
  if (mj_makeEmptyFileVFS(&files, "scene.xml", int(text.size())) != 0)
    throw std::runtime_error("MuJoCo takes no file");
  std::copy(text.begin(), text.end(), static_cast<char*>(files.filedata[0]));
  char problem[500] = "";
  mjModel* model = mj_loadXML("scene.xml", &files, problem, sizeof problem);
  mj_deleteVFS(&files);
  if (model == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + problem);
  return model;
}

class MuJoCo : public Engine {
 public:
  MuJoCo(const Task& task, bool better) {
    refuseFluids(task, "MuJoCo");
    for (const BodyDef& def : task.scene.bodies)
      if (def.material.restitution > 0) throw Unsupported("MuJoCo has no coefficient of restitution");
    // Its warnings go to a file of the folder that it is run in, and its errors end the program.
    mju_user_warning = [](const char*) {};
    mju_user_error = [](const char* text) { throw std::runtime_error(text); };
    model_.reset(load(task.scene, better));
    data_.reset(mj_makeData(model_.get()));
    for (const BodyDef& def : task.scene.bodies) {
      const bool moves = def.kind == BodyKind::Dynamic;
      bodies_.push_back(moves ? next_++ : -1);
      fixed_.push_back(def.pose);
      if (!moves) continue;
      // The velocity of a free joint: linear in the world, angular in the body.
      const Vec3 w_B = def.pose.q_WB.conjugate() * def.twist.w_WB;
      mjtNum* v = data_->qvel + 6 * bodies_.back();
      for (int i = 0; i < 3; ++i) v[i] = def.twist.v_WB[i], v[3 + i] = w_B[i];
    }
    for (const Push& push : task.pushes)
      for (int i = 0; i < 3; ++i) data_->xfrc_applied[6 * (bodies_[push.body] + 1) + i] = push.force_W[i];
  }

  void step() override { mj_step(model_.get(), data_.get()); }
  std::vector<Motion> read() const override {
    const auto warned = [this](mjtWarning about) { return data_->warning[about].number > 0; };
    if (warned(mjWARN_CONTACTFULL) || warned(mjWARN_CNSTRFULL))
      throw std::runtime_error("MuJoCo: too many contacts");
    // It starts the scene again when numbers become too large; that is no answer.
    const bool lost = warned(mjWARN_BADQPOS) || warned(mjWARN_BADQVEL) || warned(mjWARN_BADQACC);
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (lost) {
        motions.push_back({{Vec3::Constant(NAN), Quat::Identity()}, {}});
        continue;
      }
      if (bodies_[k] < 0) {
        motions.push_back({fixed_[k], {}});
        continue;
      }
      const mjtNum *x = data_->qpos + 7 * bodies_[k], *v = data_->qvel + 6 * bodies_[k];
      const Quat q(x[3], x[4], x[5], x[6]);
      motions.push_back({{Vec3(x[0], x[1], x[2]), q}, {Vec3(v[0], v[1], v[2]), q * Vec3(v[3], v[4], v[5])}});
    }
    return motions;
  }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  int next_ = 0;
  std::vector<int> bodies_;  // which free joint; -1 for static ones
  std::vector<Pose> fixed_;  // where the static ones are
};

RegisterEngine add(const std::string& setting, const std::string& sentence, bool better) {
  return RegisterEngine({"mujoco", setting, mj_versionString(), sentence,
                         [better](const Task& task) { return std::make_unique<MuJoCo>(task, better); }});
}

const RegisterEngine as_is = add("default", "Newton's method, Euler, friction pyramids", false);
const RegisterEngine better =
    add("better", "Newton's method to 1e-14, Runge-Kutta 4, elliptic friction cones", true);

}  // namespace
}  // namespace rbs::peers
