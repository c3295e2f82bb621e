#include "analysis/file_stem.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "core/error.h"

namespace npdr::analysis {

void check_file_stem(std::string_view kind, std::string_view stem) {
  const auto allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  if (!stem.empty() && std::all_of(stem.begin(), stem.end(), allowed)) return;
  throw InputError(std::string(kind) + ": name '" + std::string(stem) +
                   "', must be letters, digits, '_' and '-'");
}

}  // namespace npdr::analysis
