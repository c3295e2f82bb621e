// Replies of workers, through a shell that sends them.
#include <fstream>

#include "pipeline/sources/program_call.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_bytes.h"

namespace npdr::pipeline {
namespace {

// About two rows of two steps of one state.
const std::string kHello = "{\"npdr_worker\": 1, \"reply\": \"hello\"}\n";
const std::string kStates = "{\"npdr_worker\": 1, \"reply\": \"states\", \"shape\": [2, 2, 1]}\n";
const std::string kError =
    "{\"npdr_worker\": 1, \"reply\": \"error\", \"message\": \"out of fuel\"}\n";

std::string seed(const std::string& hello, const std::string& reply) {
  return static_cast<char>(hello.size()) + hello + reply;
}

void write(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

std::vector<std::string> worker_seeds() {
  const std::string states(2 * 2 * sizeof(double), '\0');
  return {seed(kHello, kStates + states + std::string(2, '\0')),
          seed(kHello, kStates + states + std::string{'\0', '\3'}), seed(kHello, kError)};
}

void fuzz_worker(std::string_view input, const std::filesystem::path& folder) {
  InputBytes bytes(input);
  const std::string hello(bytes.text());
  write(folder / "hello", hello);
  write(folder / "reply", bytes.rest());
  Program program;
  // Who waits for the end of a line waits for the time limit; who ends is told of at once.
  program.external.worker = hello.find('\n') == std::string::npos
                                ? "cat hello"
                                : "read line; cat hello; read line; cat reply";
  program.external.time_limit = 10.0;
  program.external.folder = folder;
  program.info.parameters = {{"a", "1", 1.0, 0.0, 2.0, "", 0.0}};
  program.info.state_channels = {{"x", "m"}};
  program.segments = {.dt = 0.1,
                      .num_rollouts = 1,
                      .steps = {2},
                      .past = {0},
                      .first_states = RowMatrix::Zero(1, 1),
                      .actions = RowMatrix::Zero(2, 0)};
  make_worker_call(program)->call({RowMatrix::Zero(2, 1), {1, 2}, 0, 5.0});
}

}  // namespace npdr::pipeline
