// The functions that judge, by check. Compiled alone: specializations must not follow their use.
#include <array>
#include <utility>

#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

constexpr auto kChecks = enum_table(Check{});

using Judge = Finding (*)(const MethodResults& m);

template <std::size_t... i>
constexpr std::array<Judge, kChecks.size()> judges(std::index_sequence<i...>) {
  return {&judge<kChecks[i].value>...};
}

}  // namespace

Finding judge(Check check, const MethodResults& m) {
  constexpr auto all = judges(std::make_index_sequence<kChecks.size()>());
  const auto row = std::ranges::find(kChecks, check, &CheckTraits::value);
  Finding found = all[static_cast<std::size_t>(row - kChecks.begin())](m);
  found.id = row->name;
  found.where = row->title;
  return found;
}

}  // namespace npdr::pipeline
