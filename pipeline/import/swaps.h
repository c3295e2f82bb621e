/// Columns of a recording whose headers are swapped. Private to pipeline/import.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/import/rate_check.h"

namespace npdr::pipeline {

/// Whether nothing is wrong; also where nothing can be said.
bool agrees(const std::optional<RateFit>& fit);

/// State c (n) without jumps by whole turns, which are told elsewhere.
Vector unwrapped(const Target& target, const Rollout& rollout, Index c);

/// Of a pair that doesn't agree: the columns that are probably swapped, since in every rollout one
/// is the slope of the other; "": none. `free`: columns, states first and actions behind them, that
/// no other pair explains.
std::string words_of_swap(const Target& target, const RatePair& pair,
                          const std::vector<Index>& free);

}  // namespace npdr::pipeline
