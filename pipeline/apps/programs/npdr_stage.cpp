// The executables of the stages: each is built of this file with a name of its own.
#include "pipeline/apps/stage_main.h"

int main(int argc, char** argv) { return npdr::pipeline::stage_main(NPDR_PROGRAM, argc, argv); }
