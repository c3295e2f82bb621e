#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) {
  using npdr::pipeline::Stage;
  return npdr::pipeline::stage_main(
      {"npdr-report", "Writes tables, figures and report.html of a study.", {Stage::report}}, argc,
      argv);
}
