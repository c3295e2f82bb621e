/// The first simulations of a study, to see whether its simulator works.
#pragma once

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Simulates the first `count` rows of the first round of the plan's first experiment, with their
/// parameters and random numbers, and prints what went in, what came out and how long it took; of a
/// study that only refines, draws of the prior. Writes no file. Throws InputError where rows are
/// finished simulations; FailedRolloutsError where none of them gives a result; what
/// RowSimulator::simulate() and, for a simulated target, Source::behave() do.
void try_rows(const Plan& plan, Index count);

}  // namespace npdr::pipeline
