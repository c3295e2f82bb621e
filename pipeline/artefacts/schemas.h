/// All kinds of artefacts, by their schemas. A version is raised whenever what a stage computes or
/// stores changes its meaning; it is part of every key, so older artefacts are simply made anew.
#pragma once

#include <optional>
#include <tuple>
#include <utility>

#include "pipeline/artefacts/layout.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// Artefacts that hold a T. A function describe(Layout, T&) beside T says what stands in them
/// (layout.h), and throws InputError for what doesn't go together when it is read.
template <class T>
struct Artefact : Schema {
  /// Fills a file in the making. Throws Error.
  void write(h5::File& file, T value) const { describe(Layout::writer(file), value); }
  /// Writes a whole artefact, such as a checkpoint; `cost`, where T has such a member, is that of
  /// the work that led to it. Throws Error.
  void write(const std::filesystem::path& path, const Identity& identity, T value) const {
    ArtefactWriter writer(path, *this, identity);
    if constexpr (requires { value.cost; }) writer.add_cost(value.cost);
    write(writer.file(), std::move(value));
    writer.finish();
  }
  /// With its cost where T has a member for it. Throws InputError.
  T read(const ArtefactFile& artefact) const {
    const h5::File file = open_artefact(artefact, *this);
    T value;
    describe(Layout::reader(file), value);
    if constexpr (requires { value.cost; }) value.cost = provenance_of(file).cost;
    return value;
  }
  /// The same of a file that may not be there, such as a checkpoint, which another process may
  /// remove at any instant.
  std::optional<T> read_if_there(const ArtefactFile& artefact) const try {
    return read(artefact);
  } catch (const Error&) {
    if (std::filesystem::exists(artefact.path)) throw;
    return std::nullopt;
  }
  /// What stands in them, for the tables of docs/file-formats.md.
  static void list(Layout f) {
    T value;
    describe(std::move(f), value);
  }
};

inline const Schema kTargetSchema{"target", 2, "target"};
inline const Artefact<struct Proposal> kProposalSchema{{"proposal", 2, "propose"}};
/// Shards lie in a folder with the key of their simulation: raise both versions together.
inline const Schema kSimulationShardSchema{"simulation_shard", 2, "simulate"};
inline const Schema kSimulationSchema{"simulation", 2, "simulate"};
inline const Schema kPosteriorSchema{"posterior", 24, "infer"};
inline const Artefact<struct TrainingCheckpoint> kCheckpointSchema{
    {"training_checkpoint", 4, "infer"}};
inline const Artefact<struct RefinementCheckpoint> kRefinementCheckpointSchema{
    {"refinement_checkpoint", 14, "infer"}};
inline const Artefact<struct AskedRows> kAskedRowsSchema{{"asked_rows", 2, "infer"}};
inline const Artefact<struct SimulatedRows> kSimulatedRowsSchema{{"simulated_rows", 2, "infer"}};
inline const Artefact<struct Baseline> kBaselineSchema{{"baseline", 9, "baseline"}};
inline const Artefact<struct Evaluation> kEvaluationSchema{{"evaluation", 11, "evaluate"}};
inline const Artefact<struct Diagnosis> kDiagnosisSchema{{"diagnosis", 10, "diagnose"}};
inline const Artefact<struct DiagnosisCheckpoint> kDiagnosisCheckpointSchema{
    {"diagnosis_checkpoint", 1, "diagnose"}};
inline const Artefact<struct FoundPolicy> kPolicySchema{{"policy", 2, "policy"}};
inline const Artefact<struct PolicyCheckpoint> kPolicyCheckpointSchema{
    {"policy_checkpoint", 1, "policy"}};
inline const Artefact<struct PolicyTest> kPolicyTestSchema{{"policy_test", 1, "policy_test"}};
inline const Schema kReportSchema{"report", 7, "report"};

/// Those that are read and written as a whole.
inline const auto kArtefacts =
    std::tie(kProposalSchema, kCheckpointSchema, kRefinementCheckpointSchema, kAskedRowsSchema,
             kSimulatedRowsSchema, kBaselineSchema, kEvaluationSchema, kDiagnosisSchema,
             kDiagnosisCheckpointSchema, kPolicySchema, kPolicyCheckpointSchema, kPolicyTestSchema);

}  // namespace npdr::pipeline
