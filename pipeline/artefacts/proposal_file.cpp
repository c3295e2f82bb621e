#include "pipeline/artefacts/proposal_file.h"

#include <span>

#include "pipeline/artefacts/described_artefact.h"

namespace npdr::pipeline {

void describe(Layout f, Proposal& proposal) {
  f("theta", proposal.theta, {{"N", "row"}, kParameter},
    "parameters; bounds of the prior's support are infinite where it has none")
      .columns(proposal.parameters);
}
template struct Artefact<Proposal>;

h5::Dataset open_proposal(const ArtefactFile& proposal) {
  h5::Dataset theta = open_artefact(proposal, kProposalSchema).dataset("theta");
  theta.require_shape({-1, -1});
  return theta;
}

RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows) {
  RowMatrix values(rows.size(), theta.row_size());
  const std::span<double> all(values.data(), static_cast<std::size_t>(values.size()));
  theta.read_rows<double>(rows.begin, values.rows(), all);
  theta.require_finite<double>(all);
  return values;
}

}  // namespace npdr::pipeline
