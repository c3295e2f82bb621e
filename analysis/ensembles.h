/// What samples say of one state after the other: their values at each rollout, time and channel.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/trajectory_view.h"
#include "core/types.h"

namespace npdr::analysis {

/// One state that an ensemble predicts.
struct Place {
  Index rollout;
  Index time;
  Index channel;
  Index row;  ///< rollout T + time, among all H T
};

using EnsembleBody = std::function<void(const Place&, std::span<double>)>;

/// Calls body(place, ensemble) for each of the H T C states, in parallel: the ensemble has a value
/// of each of `samples`, in their order, and may be changed.
void for_each_ensemble(const TrajectoryView& simulated, const std::vector<Index>& samples,
                       const EnsembleBody& body);

/// The same with ascending ensembles of values that are all finite; O(n log^2 n) each, for many of
/// them at once.
void for_each_sorted_ensemble(const TrajectoryView& simulated, const std::vector<Index>& samples,
                              const EnsembleBody& body);

}  // namespace npdr::analysis
