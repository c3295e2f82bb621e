/// Summary of a series of states in a few numbers, for people to compare.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "inference/embeddings/embedding.h"

namespace npdr::pipeline {

/// Mean, deviation, minimum, maximum and last state of each channel of each rollout of a picked
/// series (H, K, C'): 5 H C' values, rollout by rollout, channel by channel. A single state, such
/// as the features that a command gives, is its own summary: H C' values.
Vector summarize(std::span<const float> picked, const inference::SeriesSelection& selection);

/// "rollout 1, theta: mean", ...: the names of those values.
std::vector<std::string> summary_names(const inference::SeriesSelection& selection,
                                       const std::vector<Channel>& channels);

}  // namespace npdr::pipeline
