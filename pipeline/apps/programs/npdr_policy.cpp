#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-policy",
       "Searches for policies under a study's posteriors, and tests them in the target domain.",
       {Stage::policy, Stage::policy_test}},
      argc, argv);
}
