/// 128-bit XXH3 hashes, fast and wide enough that an accidental collision never happens; and keys
/// of artefacts: hashes of everything that they depend on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace npdr::pipeline {

/// Hashes what is added piece by piece. Texts and integers are delimited, so that moving a border
/// between two pieces changes the hash.
class Hasher {
 public:
  Hasher();

  void add_bytes(const void* data, std::size_t size);
  void add(std::string_view text);
  void add(std::int64_t number);
  void add(double number);

  /// 32 hexadecimal digits, of everything added so far.
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

/// 32 hexadecimal digits of a file's bytes. Throws InputError when it can't be read.
std::string file_hash(const std::filesystem::path& path);

/// The canonical text of a JSON document: members sorted by name, no white space, numbers with the
/// fewest digits that give back the same double. The order of a list counts, that of members
/// doesn't. Throws InputError for a number that isn't finite and for text that isn't UTF-8.
std::string canonical_json(const nlohmann::ordered_json& document);

/// 32 hexadecimal digits: XXH3-128 of the canonical text. Throws as canonical_json() does.
std::string content_key(const nlohmann::ordered_json& document);

}  // namespace npdr::pipeline
