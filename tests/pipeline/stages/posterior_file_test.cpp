#include "pipeline/stages/posterior_file.h"

#include "core/error.h"
#include "pipeline/config/study_json.h"
#include "pipeline/plan/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// An untrained posterior of one parameter, one feature and a small flow.
inference::DirectPosterior small_posterior(const MethodConfig& method) {
  inference::DirectPosteriorParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}}),
      .estimator = method.density_estimator,
      .trained_features = 0,
      .structure_seed = 5,
      .transform = {VectorF::Zero(1), VectorF::Ones(1), {}},
      .parameters = {},
      .x_o = VectorF::Zero(1)};
  const auto network = inference::make_network(parts.estimator, 1, 0, 1, 5);
  parts.parameters = network.initial_parameters({1, "initial", 0, 0, 0});
  return inference::DirectPosterior(parts);
}

class PosteriorFile : public ::testing::Test {
 protected:
  PosteriorFile() {
    method_.density_estimator = {.kind = "maf", .num_transforms = 2, .hidden_features = 8};
  }

  // Reads the posterior's file after `change` of its attributes.
  template <class Change>
  inference::DirectPosterior reread(const Change& change) const {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write_posterior(writer.file(), method_, small_posterior(method_), {}, {}, {});
    change(writer.file());
    writer.finish();
    return read_posterior(folder_ / "p.h5");
  }

  template <class T>
  std::string message_after(const std::string& attribute, const T& value) const {
    return message_of<InputError>(
        [&] { reread([&](h5::File& file) { file.set_attribute(attribute, value); }); }, &folder_);
  }

  std::string message_of_estimator(const inference::EstimatorConfig& config) const {
    return message_after("density_estimator", to_json(config).dump());
  }

  MethodConfig method_;
  TempFolder folder_;
};

TEST_F(PosteriorFile, ComesBackAsItWas) {
  const inference::DirectPosterior posterior = reread([](h5::File&) {});
  EXPECT_EQ(posterior.parts().parameters, small_posterior(method_).parts().parameters);
  EXPECT_EQ(posterior.parts().structure_seed, 5u);
}

TEST_F(PosteriorFile, AStructureSeedMustBeAnInteger) {
  for (const char* text : {"abc", "", "5x", "-1", "99999999999999999999"}) {
    EXPECT_EQ(
        message_after("structure_seed", std::string(text)),
        "p.h5: attribute 'structure_seed' = '" + std::string(text) + "', must be an integer >= 0");
  }
}

TEST_F(PosteriorFile, LayersOfAbsurdSizesAreRefused) {
  EXPECT_EQ(message_of_estimator({.hidden_features = 200000}),
            "p.h5: attribute 'density_estimator': hidden_features = 200000, must be >= 1 and <= "
            "4096");
  EXPECT_EQ(message_of_estimator({.num_hidden_layers = 1000000}),
            "p.h5: attribute 'density_estimator': num_hidden_layers = 1000000, must be >= 1 and <= "
            "128");
  for (const Index width : {Index{-1}, Index{1} << 40}) {
    EXPECT_EQ(message_after("trained_features", width),
              "p.h5: attribute 'trained_features' = " + std::to_string(width) +
                  ", must be >= 0 and <= 4096");
  }
}

TEST_F(PosteriorFile, ANetworkWithoutItsWeightsIsRefusedBeforeItIsMade) {
  const std::string found = std::to_string(small_posterior(method_).parts().parameters.size());
  EXPECT_EQ(message_of_estimator(
                {.num_transforms = 128, .hidden_features = 4096, .num_hidden_layers = 128}),
            "p.h5: " + found +
                " weights, but its density_estimator has more than 272730947584; rerun stage "
                "'infer'");
  EXPECT_TRUE(message_of_estimator({.kind = "mdn", .num_components = 128, .hidden_features = 8})
                  .starts_with("p.h5: posterior: " + found + " weights"));
}

}  // namespace
}  // namespace npdr::pipeline
