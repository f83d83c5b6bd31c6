// SPDX-License-Identifier: BSD-3-Clause
// The verbs of World: bodies, forces, surroundings, journal. Each does all that it was asked or raises
// InvalidInput and changes nothing.
#include "body.h"
#include "settings.h"
#include "shapes.h"
#include "values.h"
#include "world.h"

#include "rigid_body_sim/commands.h"

#include <algorithm>

namespace rbs::python {
namespace {

/// Sets a field of an edit by its name, which is that of Body. Where a pose or a velocity is given in part, the rest
/// stays as it is now.
void setField(BodyEdit& edit, const World& world, BodyId id, const std::string& name, py::handle value) {
  const auto pose = [&]() -> Pose& {
    if (!edit.pose) edit.pose = world.pose(id);
    return *edit.pose;
  };
  const auto twist = [&]() -> Twist& {
    if (edit.twist) return *edit.twist;
    const std::vector<BodyState> states = world.states();
    const auto at = std::lower_bound(states.begin(), states.end(), id,
                                     [](const BodyState& state, BodyId wanted) { return state.id < wanted; });
    return edit.twist.emplace(at->twist);
  };
  if (name == "name") return void(edit.name = toText(value, name));
  if (name == "shape") return void(edit.shape = toShape(value, name));
  if (name == "position") return void(pose().p_WB = toVec3(value, name));
  if (name == "orientation") return void(pose().q_WB = toQuat(value, name));
  if (name == "velocity") return void(twist().v_WB = toVec3(value, name));
  if (name == "spin") return void(twist().w_WB = toVec3(value, name));
  if (name == "kind") return void(edit.kind = toKind(value, name));
  if (name == "color") return void(edit.color = toColor(value, name));
  if (name == "group") return void(edit.group = toBits(value, name));
  if (name == "mask") return void(edit.mask = toBits(value, name));
  struct Number {
    const char* name;
    std::optional<double> BodyEdit::*field;
  };
  for (const Number& number :
       {Number{"mass", &BodyEdit::mass}, Number{"density", &BodyEdit::density},
        Number{"friction", &BodyEdit::friction}, Number{"restitution", &BodyEdit::restitution},
        Number{"drag_coefficient", &BodyEdit::drag_coefficient},
        Number{"rolling_resistance", &BodyEdit::rolling_resistance},
        Number{"torsional_resistance", &BodyEdit::torsional_resistance}})
    if (name == number.name) return void(edit.*number.field = toNumber(value, name));
  refuse(name, textOf(value), fieldsOf(py::type::of<BodyDef>()));
}

void editBody(PyWorld& world, py::handle body, const py::kwargs& fields) {
  const World& w = world.read();
  const BodyId id = toBodyId(w, body, "body");
  w.pose(id);  // throws for a handle of no body
  BodyEdit edit;
  for (const auto& [name, value] : fields) setField(edit, w, id, name.cast<std::string>(), value);
  world.change().editBody(id, edit);
}

py::list addBodies(PyWorld& world, py::handle bodies) {
  py::list ids;
  for (const BodyId id : world.change().addBodies(toBodies(bodies, "bodies"))) ids.append(id.serial);
  return ids;
}

std::uint64_t addBody(PyWorld& world, py::handle body) {
  if (!py::isinstance<BodyDef>(body)) refuse("body", textOf(body), "a Body");
  return world.change().addBody(body.cast<const BodyDef&>()).serial;
}

/// The core does not check these arguments.
py::array_t<double> freePlace(const World& world, const Shape& shape, const Quat& orientation,
                              double clearance) {
  BodyDef body;
  body.shape = shape;
  body.pose.q_WB = orientation;
  body.kind = BodyKind::Static;
  std::vector<Problem> problems = validate(body, "body");
  if (!(clearance >= 0.0 && clearance <= Limits::max_position))
    problems.push_back({"clearance", std::to_string(clearance), "0 to 1e9 m"});
  if (!problems.empty()) throw InvalidInput(std::move(problems));
  return fromVec3(world.freePlace(shape, orientation.normalized(), clearance));
}

void bindBodies(WorldClass& type) {
  type.def("add_body", &addBody, py::arg("body"),
           Doc("Adds a body and returns its handle, 1 or more, which the world never gives again.\n\nRaises "
               "InvalidInput for a faulty body or a name that is taken."))
      .def("add_bodies", &addBodies, py::arg("bodies"),
           Doc("Adds all bodies of a sequence or none, and returns their handles: faster than one by "
               "one.\n\nRaises InvalidInput with every fault."))
      .def(
          "remove_body",
          [](PyWorld& world, py::handle body) {
            world.change().removeBody(toBodyId(world.read(), body, "body"));
          },
          py::arg("body"), Doc("Removes a body with all that acts on it.\n\nbody: handle or name."))
      .def(
          "clear", [](PyWorld& world) { world.change().clear(); },
          Doc("Removes all bodies, contacts, wrenches, grabs and holds. Time, steps and settings stay."))
      .def("edit_body", &editBody, py::arg("body"),
           Doc("Changes properties of a body: edit_body('box', friction=0.3, position=[0, 0, 2]). The fields "
               "are those of Body.\n\nbody: handle or name. Raises InvalidInput for a faulty field, mass and "
               "density together, and a name that another body has."))
      .def(
          "free_place",
          [](const PyWorld& world, py::handle shape, py::handle orientation, py::handle clearance) {
            return freePlace(world.read(), toShape(shape, "shape"), toQuat(orientation, "orientation"),
                             toNumber(clearance, "clearance"));
          },
          py::arg("shape"), py::arg("orientation") = py::make_tuple(0.0, 0.0, 0.0, 1.0),
          py::arg("clearance") = 0.5,
          Doc("The lowest free position of the centre of mass above x = y = 0 for this shape: (3,) in W, "
              "m.\n\nclearance: least height of its lowest point above z = 0, m, 0 to 1e9."));
}

// World::applyWrench() or World::commandWrench().
template <auto kPush>
void push(PyWorld& world, py::handle body, py::handle force, py::handle torque, py::handle point,
          py::handle seconds) {
  const Vec3 force_W = toVec3(force, "force"), torque_W = toVec3(torque, "torque"),
             point_W = toVec3(point, "point");
  const double time = toNumber(seconds, "seconds");
  (world.change().*kPush)(toBodyId(world.read(), body, "body"), force_W, torque_W, point_W, time);
}

void bindForces(WorldClass& type) {
  type.def(
          "apply_impulse",
          [](PyWorld& world, py::handle body, py::handle impulse, py::handle point) {
            const Vec3 impulse_W = toVec3(impulse, "impulse"), point_W = toVec3(point, "point");
            world.change().applyImpulse(toBodyId(world.read(), body, "body"), impulse_W, point_W);
          },
          py::arg("body"), py::arg("impulse"), py::arg("point"),
          Doc("Changes the velocity of a body at once.\n\nbody: handle or name, of a dynamic body, neither "
              "held nor frozen. impulse: (3,) in W, N s. point: (3,) in W, m."))
      .def("apply_wrench", &push<&World::applyWrench>, py::arg("body"), py::arg("force"), py::arg("torque"),
           py::arg("point"), py::arg("seconds"),
           Doc("Applies a force and a torque from now on; they add to those that act already.\n\nbody: "
               "handle or name, of a dynamic body, neither held nor frozen. force: (3,) in W, N. torque: "
               "(3,) in W, N m.\npoint: (3,) in W, m, where the force acts now; it moves with the body. "
               "seconds: of physics time, above 0 to 1e9."))
      .def("command_wrench", &push<&World::commandWrench>, py::arg("body"), py::arg("force"),
           py::arg("torque"), py::arg("point"), py::arg("seconds"),
           Doc("Replaces the last commanded wrench of a body, as a controller does; apply_wrench() has the "
               "arguments.\n\nseconds: its time-out."))
      .def(
          "grab",
          [](PyWorld& world, py::handle body, py::handle target, py::handle point, py::handle frequency,
             py::handle acceleration) {
            const Grab grab{toVec3(point, "point"), toVec3(target, "target"),
                            toNumber(frequency, "frequency"), toNumber(acceleration, "max_acceleration")};
            world.change().grab(toBodyId(world.read(), body, "body"), grab);
          },
          py::arg("body"), py::arg("target"), py::arg("point") = py::make_tuple(0.0, 0.0, 0.0),
          py::arg("frequency") = Grab{}.frequency, py::arg("max_acceleration") = Grab{}.max_acceleration,
          Doc("Pulls a body by a critically damped spring until release().\n\nbody: handle or name, of a "
              "dynamic body. target: (3,) in W, m. point: (3,) of the body that the spring holds, in B, "
              "m.\nfrequency: Hz, above 0 to 1e4. max_acceleration: cap on the spring's force over the mass, "
              "m/s², above 0 to 1e9."))
      .def(
          "hold",
          [](PyWorld& world, py::handle body, py::handle position, py::handle orientation) {
            const BodyId id = toBodyId(world.read(), body, "body");
            Pose target = world.read().pose(id);
            target.p_WB = toVec3(position, "position");
            if (!orientation.is_none()) target.q_WB = toQuat(orientation, "orientation");
            world.change().hold(id, target);
          },
          py::arg("body"), py::arg("position"), py::arg("orientation") = py::none(),
          Doc("Moves a body of any kind to a kinematic target until release(), whatever it meets.\n\nbody: "
              "handle or name. position: (3,) in W, m. orientation: (4,) [x, y, z, w]; None: that of now."))
      .def(
          "release",
          [](PyWorld& world, py::handle body) {
            world.change().release(toBodyId(world.read(), body, "body"));
          },
          py::arg("body"), Doc("Ends the grab or hold of a body.\n\nbody: handle or name."))
      .def(
          "release_all", [](PyWorld& world) { world.change().releaseAll(); },
          Doc("Ends all grabs and holds."));
}

void bindSurroundings(WorldClass& type) {
  type.def(
          "set_gravity",
          [](PyWorld& world, py::handle gravity) { world.change().setGravity(toVec3(gravity, "gravity")); },
          py::arg("gravity"), Doc("gravity: (3,) in W, m/s², at most 1e7; zero is none."))
      .def(
          "set_air",
          [](PyWorld& world, py::handle air) { world.change().setAir(toOptional(air, "air", toAir)); },
          py::arg("air"), Doc("air: Air, or None, which takes the wind with it."))
      .def(
          "set_wind",
          [](PyWorld& world, py::handle wind) { world.change().setWind(toOptional(wind, "wind", toWind)); },
          py::arg("wind"), Doc("wind: Wind, which needs air, or None: air at rest."))
      .def(
          "set_fluid",
          [](PyWorld& world, py::handle fluid) {
            world.change().setFluid(toOptional(fluid, "fluid", toFluid));
          },
          py::arg("fluid"), Doc("fluid: Fluid, or None."))
      .def(
          "set_fidelity",
          [](PyWorld& world, py::handle setting) {
            world.change().setFidelity(toSetting(setting, "fidelity"));
          },
          py::arg("setting"),
          Doc("setting: Setting, or the name of a quality level. Bodies keep their state, bit for bit."))
      .def(
          "set_goal",
          [](PyWorld& world, py::handle goal) { world.change().setGoal(toOptional(goal, "goal", toGoal)); },
          py::arg("goal"), Doc("goal: Goal, or None. A simulator follows it; step() does not."))
      .def(
          "set_effects",
          [](PyWorld& world, py::handle effects) {
            world.change().setEffects(toEffects(effects, "effects"));
          },
          py::arg("effects"),
          Doc("Replaces all overrides of effects: a dictionary of name to True or False. Those not in it are "
              "detected."));
}

void bindJournal(WorldClass& type) {
  type.def("set_journal", &PyWorld::setJournal, py::arg("journal"),
           Doc("Calls journal(text) after each change, with the command that makes it again: one line of "
               "YAML.\n\njournal: a function, which may not use the world, or None."))
      .def(
          "execute",
          [](PyWorld& world, py::handle command, py::handle source) {
            execute(world.change(), parseCommand(toText(command, "command"), toText(source, "source")));
          },
          py::arg("command"), py::arg("source") = "command",
          Doc("Executes a command, as a journal or ~commands of a simulator has it.\n\nsource: names the "
              "text in messages. Raises InvalidInput with every fault."));
}

}  // namespace

void bindEdits(WorldClass& type) {
  bindBodies(type);
  bindForces(type);
  bindSurroundings(type);
  bindJournal(type);
}

}  // namespace rbs::python
