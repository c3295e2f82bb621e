#include "pipeline/artefacts/usual_features_file.h"

#include "core/error.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

void describe(Layout f, std::optional<inference::UsualFeatures>& usual) {
  auto group = f.group("usual", usual);
  if (!group) return;
  inference::UsualFeatures& u = *usual;
  describe(*group, u.transform);
  (*group)("known", u.known, {{"m", "simulation"}, {"k", "component"}},
           "z of simulations that an x is compared with", kFinite);
  (*group)("distances", u.distances, {{"n", "simulation"}, {"3", "distance"}},
           "of others: length of z, residual beyond the components, to the nearest of `known`",
           kFinite);
  (*group)("lowest", u.lowest, {kFeature}, "value of each feature in all of these simulations",
           kFinite);
  (*group)("highest", u.highest, {kFeature}, "the same", kFinite);
  if (!f.reads()) return;
  const bool fits = u.transform.basis.cols() == u.known.cols();
  if (fits && u.known.size() > 0 && u.distances.rows() > 0) return;
  throw InputError(group->where() + ": nothing to compare an x with; rerun stage 'infer'");
}

std::optional<inference::UsualFeatures> read_usual_features(const ArtefactFile& posterior) {
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  Layout f = Layout::reader(file);
  VectorF x_o;
  f("x_o", x_o, {kFeature}, "", kFinite);
  std::optional<inference::UsualFeatures> usual;
  describe(f, usual);
  return usual;
}

}  // namespace npdr::pipeline
