#include "sim/mujoco/model.h"

#include <fmt/format.h>

#include <array>
#include <csetjmp>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace npdr::mujoco {
namespace {

// Where this thread goes on after an error. MuJoCo is C: nothing between here and there has a
// destructor.
thread_local std::jmp_buf* after_error = nullptr;
thread_local std::array<char, 500> last_error = {};

void on_error(const char* message) {
  std::snprintf(last_error.data(), last_error.size(), "%s", message);
  if (after_error != nullptr) std::longjmp(*after_error, 1);
  std::fprintf(stderr, "MuJoCo: %s\n", message);
  std::abort();
}

// Warnings are counted in mjData; by default they are written to a file in the current folder.
void on_warning(const char* /*message*/) {}

void install_handlers() {
  mju_user_error = on_error;
  mju_user_warning = on_warning;
}

}  // namespace

bool without_errors(void (*step)(void*), void* argument) {
  std::jmp_buf place;
  std::jmp_buf* const before = after_error;
  after_error = &place;
  const bool is_done = setjmp(place) == 0;
  if (is_done) step(argument);
  after_error = before;
  return is_done;
}

Spec parse(const std::string& file) {
  install_handlers();
  std::array<char, 1000> error = {};
  Spec spec(mj_parseXML(file.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!spec) throw std::runtime_error(fmt::format("MuJoCo can't read it: {}", error.data()));
  return spec;
}

Model try_compile(mjSpec* spec) { return Model(mj_compile(spec, nullptr)); }

Model compile(mjSpec* spec) {
  Model model = try_compile(spec);
  if (!model) throw std::runtime_error(fmt::format("MuJoCo can't use it: {}", mjs_getError(spec)));
  return model;
}

std::string fingerprint(const mjModel* model) {
  const auto size = static_cast<std::size_t>(mj_sizeModel(model));
  std::vector<unsigned char> bytes(size);
  mj_saveModel(model, nullptr, bytes.data(), static_cast<int>(size));
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return fmt::format("MuJoCo {}, {:016x}", mj_versionString(), hash);
}

}  // namespace npdr::mujoco
