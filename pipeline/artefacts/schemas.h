/// The schema of each stage's artefact. A version is raised whenever what a stage computes or
/// stores changes its meaning; it is part of every key, so older artefacts are simply made anew.
#pragma once

#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

inline const Schema kTargetSchema{"target", 2, "target"};
inline const Schema kProposalSchema{"proposal", 2, "propose"};
/// Shards lie in a folder with the key of their simulation: raise both versions together.
inline const Schema kSimulationShardSchema{"simulation_shard", 2, "simulate"};
inline const Schema kSimulationSchema{"simulation", 2, "simulate"};
inline const Schema kPosteriorSchema{"posterior", 22, "infer"};
inline const Schema kCheckpointSchema{"training_checkpoint", 4, "infer"};
inline const Schema kRefinementCheckpointSchema{"refinement_checkpoint", 13, "infer"};
inline const Schema kAskedRowsSchema{"asked_rows", 2, "infer"};
inline const Schema kSimulatedRowsSchema{"simulated_rows", 2, "infer"};
inline const Schema kBaselineSchema{"baseline", 6, "baseline"};
inline const Schema kEvaluationSchema{"evaluation", 11, "evaluate"};
inline const Schema kDiagnosisSchema{"diagnosis", 9, "diagnose"};
inline const Schema kDiagnosisCheckpointSchema{"diagnosis_checkpoint", 1, "diagnose"};
inline const Schema kPolicySchema{"policy", 2, "policy"};
inline const Schema kPolicyCheckpointSchema{"policy_checkpoint", 1, "policy"};
inline const Schema kPolicyTestSchema{"policy_test", 1, "policy_test"};
inline const Schema kReportSchema{"report", 7, "report"};

}  // namespace npdr::pipeline
