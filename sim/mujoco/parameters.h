/// Domain parameters of a model of MuJoCo, by element and attribute.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sim/mujoco/model.h"

namespace npdr::mujoco {

/// A number in a model that a study may call unknown.
///
///   option.timestep [s], option.gravity [m/s^2]: its magnitude, the direction stays
///   body.NAME.mass [kg]: its inertia is scaled with it, so that it stays physical
///   geom.NAME.mass [kg], density [kg/m^3], size1, size2, size3 [m]: the body's mass, center and
///       inertia are computed anew from all of its geoms, as when a model is read
///   geom.NAME.friction: sliding
///   joint.NAME.damping, frictionloss, armature, stiffness, springref; hinges and slides
///   actuator.NAME.gear: the first of its six
///   actuator.NAME.delay [steps of the recording]: controls reach the actuator so much later
struct MujocoParameter {
  std::string name;
  std::string unit;
  double nominal = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::string description;

  /// Where the number is written to before a model is compiled; nullptr: it needs no compiler.
  double* in_spec = nullptr;
  /// Writes it into a compiled model; empty: the compiler has.
  std::function<void(mjModel*, double)> write;
  /// Whether MuJoCo has to compute constants of the model anew after it was written.
  bool changes_constants = false;
  /// The actuator that it delays; -1: none.
  int delayed_actuator = -1;
};

/// Finds the parameter `name` in the model. Throws std::runtime_error that says what there is.
MujocoParameter find_parameter(const std::string& name, mjSpec* spec, const mjModel* model);

/// Names of what is usually unknown in a model: masses of moving bodies, damping and dry friction
/// of hinges and slides, gear and delay of actuators.
std::vector<std::string> parameter_names(const mjModel* model);

/// All names of elements of a kind that have one: "cart, pole".
std::string names_of(const mjModel* model, mjtObj kind);

}  // namespace npdr::mujoco
