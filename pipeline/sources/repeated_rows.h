/// Rows of x that are the same for different theta: what a program leaves where it has failed.
#pragma once

#include <string>

#include "core/types.h"

namespace npdr::pipeline {

/// Says how many of the rows of x (n, F), the first of a simulation, are the same to the last bit
/// though their theta (n, P) differ, where that are three or more and nine tenths of the others are
/// like no other; "": there are none. Rows that aren't finite don't count;
/// nothing is said of a single column, which may be censored, and of whole numbers, which may all
/// be 0.
std::string repeated_rows(const RowMatrix& theta, const RowMatrixF& x);

}  // namespace npdr::pipeline
