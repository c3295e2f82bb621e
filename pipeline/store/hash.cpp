#include "pipeline/store/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <new>
#include <vector>

#include "core/error.h"

namespace npdr::pipeline {

struct Hasher::State {
  XXH3_state_t* value = XXH3_createState();
  State() {
    if (value == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(value);
  }
  ~State() { XXH3_freeState(value); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

Hasher::Hasher() : state_(std::make_unique<State>()) {}

Hasher::~Hasher() = default;

void Hasher::add_bytes(const void* data, std::size_t size) {
  XXH3_128bits_update(state_->value, data, size);
}

void Hasher::add(std::string_view text) {
  add(static_cast<std::int64_t>(text.size()));
  add_bytes(text.data(), text.size());
}

void Hasher::add(std::int64_t number) { add_bytes(&number, sizeof number); }

void Hasher::add(double number) { add_bytes(&number, sizeof number); }

std::string Hasher::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->value);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string file_hash(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path.string() + ": can't be opened; may you read it?");
  Hasher hasher;
  std::vector<char> block(1 << 20);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) ||
         stream.gcount() > 0) {
    hasher.add_bytes(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) throw InputError(path.string() + ": reading failed");
  return hasher.hex();
}

}  // namespace npdr::pipeline
