#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-infer",
       "Trains the density estimator of a round: simulations to posterior.",
       {Stage::infer}},
      argc, argv);
}
