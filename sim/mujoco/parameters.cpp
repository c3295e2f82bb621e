#include "sim/mujoco/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace npdr::mujoco {
namespace {

// Masses below it are none: MuJoCo's own smallest value.
constexpr double kLeast = mjMINVAL;

[[noreturn]] void fail(const std::string& message) { throw std::runtime_error(message); }

// "geom.pole.mass" as "geom", "pole", "mass"; names of elements may have points of their own.
struct Address {
  std::string kind, element, attribute;
};

Address split(const std::string& name) {
  const std::size_t first = name.find('.'), last = name.rfind('.');
  if (first == std::string::npos) {
    fail(
        fmt::format("parameter '{}': must be ELEMENT.NAME.ATTRIBUTE, such as geom.pole.mass, or "
                    "option.gravity",
                    name));
  }
  if (first == last) return {name.substr(0, first), "", name.substr(first + 1)};
  return {name.substr(0, first), name.substr(first + 1, last - first - 1), name.substr(last + 1)};
}

int require_element(const Address& address, const mjModel* model, mjtObj kind) {
  const int id = mj_name2id(model, kind, address.element.c_str());
  if (id >= 0) return id;
  fail(fmt::format("the model has no {} called '{}'; it has: {}", address.kind, address.element,
                   names_of(model, kind)));
}

[[noreturn]] void fail_attribute(const Address& address, const char* known) {
  fail(fmt::format("{}.{}: unknown attribute '{}', must be one of {}", address.kind,
                   address.element, address.attribute, known));
}

MujocoParameter option(const Address& address, const mjModel* model) {
  MujocoParameter p;
  p.lower = 0.0;
  if (address.attribute == "timestep") {
    p.unit = "s";
    p.nominal = model->opt.timestep;
    p.lower = 1e-9;
    p.description = "integrator's step, rounded to a whole part of the recording's";
    p.write = [](mjModel* m, double value) { m->opt.timestep = value; };
  } else if (address.attribute == "gravity") {
    p.unit = "m/s^2";
    p.nominal = mju_norm3(model->opt.gravity);
    p.description = "magnitude of gravity, whose direction stays";
    double direction[3] = {model->opt.gravity[0], model->opt.gravity[1], model->opt.gravity[2]};
    if (p.nominal == 0.0) {
      fail("option.gravity: the model has none, and so no direction");
    }
    const std::vector<double> unit = {direction[0] / p.nominal, direction[1] / p.nominal,
                                      direction[2] / p.nominal};
    p.write = [unit](mjModel* m, double value) {
      for (std::size_t i = 0; i < 3; ++i) m->opt.gravity[i] = value * unit[i];
    };
  } else {
    fail_attribute(address, "timestep, gravity");
  }
  return p;
}

MujocoParameter body(const Address& address, const mjModel* model) {
  if (address.attribute != "mass") fail_attribute(address, "mass");
  const int id = require_element(address, model, mjOBJ_BODY);
  MujocoParameter p;
  p.unit = "kg";
  p.nominal = model->body_mass[id];
  p.lower = kLeast;
  p.description = "mass of the body, whose inertia is scaled with it";
  if (p.nominal < kLeast) fail(fmt::format("body.{}.mass: it has none", address.element));
  p.changes_constants = true;
  // The inertia may be that of a geometry which is unknown, too.
  p.write = [id](mjModel* m, double value) {
    const double share = value / m->body_mass[id];
    m->body_mass[id] = value;
    for (int i = 0; i < 3; ++i) m->body_inertia[3 * id + i] *= share;
  };
  return p;
}

// The mass of a geom that the model may give as a density: what the body is lighter by when the
// geom weighs another amount.
double mass_of(mjsGeom* geom, int body, mjSpec* spec, const mjModel* model,
               const std::string& name) {
  if (std::isfinite(geom->mass)) return geom->mass;
  const double before = geom->mass;
  geom->mass = 1.0;
  const Model other = compile(spec);
  geom->mass = before;
  const double mass = 1.0 - (other->body_mass[body] - model->body_mass[body]);
  if (std::abs(other->body_mass[body] - model->body_mass[body]) < kLeast &&
      std::abs(mass - 1.0) < kLeast) {
    fail(
        fmt::format("geom.{}.mass: changes nothing, as its body has an <inertial> element; "
                    "body.NAME.mass is what counts",
                    name));
  }
  return mass;
}

MujocoParameter geom(const Address& address, mjSpec* spec, const mjModel* model) {
  const int id = require_element(address, model, mjOBJ_GEOM);
  mjsGeom* const element = mjs_asGeom(mjs_findElement(spec, mjOBJ_GEOM, address.element.c_str()));
  const std::string& a = address.attribute;
  MujocoParameter p;
  p.lower = 0.0;
  if (a == "friction") {
    p.unit = "1";
    p.nominal = model->geom_friction[3 * id];
    p.description = "sliding friction";
    p.write = [id](mjModel* m, double value) { m->geom_friction[3 * id] = value; };
    return p;
  }
  if (a == "mass") {
    p.unit = "kg";
    p.nominal = mass_of(element, model->geom_bodyid[id], spec, model, address.element);
    p.description = "mass of the geom, spread evenly over it";
    p.in_spec = &element->mass;
  } else if (a == "density") {
    p.unit = "kg/m^3";
    p.nominal = element->density;
    p.description = "density of the geom";
    if (std::isfinite(element->mass)) fail("geom." + address.element + ".density: it has a mass");
    p.in_spec = &element->density;
  } else if (a == "size1" || a == "size2" || a == "size3") {
    const auto i = static_cast<std::size_t>(a.back() - '1');
    p.unit = "m";
    p.nominal = element->size[i];
    if (!(p.nominal >= kLeast)) {
      fail(
          fmt::format("geom.{}.{}: the model gives none: its type has none, or 'fromto' or a mesh "
                      "says it",
                      address.element, a));
    }
    p.lower = kLeast;
    p.description = "size of the geom";
    p.in_spec = &element->size[i];
  } else {
    fail_attribute(address, "mass, density, size1, size2, size3, friction");
  }
  return p;
}

MujocoParameter joint(const Address& address, const mjModel* model) {
  const int id = require_element(address, model, mjOBJ_JOINT);
  const bool is_hinge = model->jnt_type[id] == mjJNT_HINGE;
  if (!is_hinge && model->jnt_type[id] != mjJNT_SLIDE) {
    fail(fmt::format("joint.{}: is neither a hinge nor a slide", address.element));
  }
  const int dof = model->jnt_dofadr[id];
  const std::string& a = address.attribute;
  MujocoParameter p;
  p.lower = 0.0;
  const auto array = [&](auto field, int index, const char* hinge, const char* slide,
                         const char* description) {
    p.unit = is_hinge ? hinge : slide;
    p.nominal = (model->*field)[index];
    p.description = description;
    p.write = [field, index](mjModel* m, double value) { (m->*field)[index] = value; };
  };
  if (a == "damping") {
    array(&mjModel::dof_damping, dof, "N m s/rad", "N s/m", "viscous damping");
  } else if (a == "frictionloss") {
    array(&mjModel::dof_frictionloss, dof, "N m", "N", "dry friction");
  } else if (a == "armature") {
    array(&mjModel::dof_armature, dof, "kg m^2", "kg", "inertia of the rotor");
    p.changes_constants = true;
  } else if (a == "stiffness") {
    array(&mjModel::jnt_stiffness, id, "N m/rad", "N/m", "stiffness of the spring");
  } else if (a == "springref") {
    array(&mjModel::qpos_spring, model->jnt_qposadr[id], "rad", "m", "where the spring is at rest");
    p.lower = -std::numeric_limits<double>::infinity();
  } else {
    fail_attribute(address, "damping, frictionloss, armature, stiffness, springref");
  }
  return p;
}

MujocoParameter actuator(const Address& address, const mjModel* model) {
  const int id = require_element(address, model, mjOBJ_ACTUATOR);
  MujocoParameter p;
  if (address.attribute == "gear") {
    p.unit = "1";
    p.nominal = model->actuator_gear[6 * id];
    p.description = "scales the actuator's force";
    p.write = [id](mjModel* m, double value) { m->actuator_gear[6 * id] = value; };
    p.changes_constants = true;
  } else if (address.attribute == "delay") {
    p.unit = "steps";
    p.lower = 0.0;
    p.description = "time until a control reaches the actuator";
    p.delayed_actuator = id;
  } else {
    fail_attribute(address, "gear, delay");
  }
  return p;
}

}  // namespace

std::string names_of(const mjModel* model, mjtObj kind) {
  const int count = kind == mjOBJ_BODY     ? static_cast<int>(model->nbody)
                    : kind == mjOBJ_GEOM   ? static_cast<int>(model->ngeom)
                    : kind == mjOBJ_JOINT  ? static_cast<int>(model->njnt)
                    : kind == mjOBJ_SENSOR ? static_cast<int>(model->nsensor)
                                           : static_cast<int>(model->nu);
  std::string names;
  for (int i = 0; i < count; ++i) {
    const char* const name = mj_id2name(model, kind, i);
    if (name == nullptr || *name == '\0') continue;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return names.empty() ? "none that has a name" : names;
}

std::vector<std::string> parameter_names(const mjModel* model) {
  std::vector<std::string> names;
  const auto add = [&](const char* kind, mjtObj type, int id, const char* attribute) {
    const char* const name = mj_id2name(model, type, id);
    if (name != nullptr && *name != '\0')
      names.push_back(fmt::format("{}.{}.{}", kind, name, attribute));
  };
  for (int i = 1; i < static_cast<int>(model->nbody); ++i) {
    if (model->body_mass[i] >= kLeast) add("body", mjOBJ_BODY, i, "mass");
  }
  for (const char* attribute : {"damping", "frictionloss"}) {
    for (int i = 0; i < static_cast<int>(model->njnt); ++i) {
      const bool is_single = model->jnt_type[i] == mjJNT_HINGE || model->jnt_type[i] == mjJNT_SLIDE;
      if (is_single) add("joint", mjOBJ_JOINT, i, attribute);
    }
  }
  for (const char* attribute : {"gear", "delay"}) {
    for (int i = 0; i < static_cast<int>(model->nu); ++i)
      add("actuator", mjOBJ_ACTUATOR, i, attribute);
  }
  return names;
}

MujocoParameter find_parameter(const std::string& name, mjSpec* spec, const mjModel* model) {
  const Address address = split(name);
  MujocoParameter found = [&] {
    if (address.kind == "option") return option(address, model);
    if (address.kind == "body") return body(address, model);
    if (address.kind == "geom") return geom(address, spec, model);
    if (address.kind == "joint") return joint(address, model);
    if (address.kind == "actuator") return actuator(address, model);
    fail(
        fmt::format("parameter '{}': must begin with option, body, geom, joint or actuator", name));
  }();
  found.name = name;
  return found;
}

}  // namespace npdr::mujoco
