#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-evaluate",
       "Simulates posterior samples and measures how well they fit the target domain.",
       {Stage::baseline, Stage::evaluate}},
      argc, argv);
}
