/// A model of MuJoCo, compiled, and what becomes of MuJoCo's errors.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

namespace npdr::mujoco {

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
struct DeleteSpec {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using Model = std::unique_ptr<mjModel, DeleteModel>;
using Data = std::unique_ptr<mjData, DeleteData>;
using Spec = std::unique_ptr<mjSpec, DeleteSpec>;

/// Reads an MJCF file. Throws std::runtime_error with MuJoCo's words.
Spec parse(const std::string& file);

/// Compiles it; nullptr when what it describes is impossible, such as a body without mass.
Model try_compile(mjSpec* spec);
/// The same; throws std::runtime_error.
Model compile(mjSpec* spec);

/// Calls `step`, which may call MuJoCo but owns nothing that needs a destructor; false when MuJoCo
/// has reported an error, of which nothing can be gone on from.
bool without_errors(void (*step)(void*), void* argument);

/// A hash of all that the compiled model holds, meshes included, and MuJoCo's version.
std::string fingerprint(const mjModel* model);

}  // namespace npdr::mujoco
