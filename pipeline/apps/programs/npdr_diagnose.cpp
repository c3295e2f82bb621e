#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-diagnose",
       "Checks posteriors: their calibration, and whether the observation is like what was "
       "simulated.",
       {Stage::diagnose}},
      argc, argv);
}
