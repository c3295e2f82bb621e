#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-simulate",
       "Simulates the proposed parameters in shards, and joins them when all are there.",
       {Stage::simulate}},
      argc, argv);
}
