#include "pipeline/store/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>
#include <fstream>
#include <new>
#include <vector>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

// JSON would write null for all of them, so that different documents would share a key.
void require_finite(const nlohmann::ordered_json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    throw InputError("a key document holds a number that isn't finite");
  }
  if (!value.is_structured()) return;
  for (const nlohmann::ordered_json& member : value) require_finite(member);
}

}  // namespace

Hasher::Hasher() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

void Hasher::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

void Hasher::add_bytes(const void* data, std::size_t size) {
  XXH3_128bits_update(state_.get(), data, size);
}

void Hasher::add(std::string_view text) {
  add(static_cast<std::int64_t>(text.size()));
  add_bytes(text.data(), text.size());
}

void Hasher::add(std::int64_t number) { add_bytes(&number, sizeof number); }

void Hasher::add(double number) { add_bytes(&number, sizeof number); }

std::string Hasher::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
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

std::string canonical_json(const nlohmann::ordered_json& document) {
  require_finite(document);
  try {
    return nlohmann::json(document).dump();  // nlohmann::json sorts members
  } catch (const nlohmann::json::type_error& error) {
    throw InputError(std::string("a key document holds text that isn't UTF-8: ") + error.what());
  }
}

std::string content_key(const nlohmann::ordered_json& document) {
  const std::string text = canonical_json(document);
  Hasher hasher;
  hasher.add_bytes(text.data(), text.size());
  return hasher.hex();
}

}  // namespace npdr::pipeline
