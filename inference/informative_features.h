/// Which features tell the parameters, where there are many that don't.
///
/// Feature z_j, standardized and cut off at +-3, is taken to tell them where a correlation of z_j
/// or z_j^2 with any u_d or u_d^2 is more than five of its standard errors, 1 / sqrt(n), which a
/// feature that is independent of theta passes with probability 6e-7 a pair (screening by marginal
/// correlations: Fan and Lv 2008, "Sure independence screening for ultrahigh dimensional feature
/// space"). Squares see features whose spread alone depends on theta. A feature that tells theta
/// only together with others isn't found.
#pragma once

#include <vector>

#include "inference/feature_transform.h"

namespace npdr::inference {

/// Numbers of those features, ascending. u: (n, D), of the first n rows of x, of which 10,000 at
/// most are looked at; `transform`: that standardizes x.
std::vector<Index> informative_features(const FeatureSource& x, const FeatureTransform& transform,
                                        const RowMatrix& u);

}  // namespace npdr::inference
