#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-propose",
       "Draws the parameters of a round's simulations, from the prior or the last posterior.",
       {Stage::target, Stage::held_out, Stage::propose}},
      argc, argv);
}
