/// Share of a density pi(u) that another one, q(u), has missed, as a mode that a network hasn't
/// learned: the mass of pi where q is less than e^-(4 + 2 D) times as large. Draws of q can't tell,
/// since there are none. A search (samplers/weight_search.h) from draws of q and of the prior finds
/// places where pi / q is large; as many draws of q as around these places, weighted as draws of pi
/// by the density of their mixture (Veach and Guibas 1995), tell the share.
#pragma once

#include <functional>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Logs of both densities over that of the prior, N(u; 0, I), at the rows of u (n, D), (n) each:
/// of pi up to a constant. NaN is -infinity.
struct ComparedDensities {
  Vector q;
  Vector pi;
};

/// u (n, D): draws of q. 0 where the search finds nothing of 1 % of pi or more. It depends on the
/// arguments alone.
double missed_share(const RowMatrix& u,
                    const std::function<ComparedDensities(const RowMatrix& u)>& densities,
                    const StreamId& id);

}  // namespace npdr::inference
