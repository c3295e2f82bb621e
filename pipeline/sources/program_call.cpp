#include "pipeline/sources/program_call.h"

#include <fmt/format.h>

#include <cstdlib>

#include "pipeline/process/child_process.h"

namespace npdr::pipeline {
namespace {

// The folder of npdr_worker.py and npdr_command.py, beside that of the executables, before what it
// is already.
std::string python_path() {
  std::string path = (executable_folder().parent_path() / "lib").string();
  const char* const own = std::getenv("PYTHONPATH");
  return own == nullptr || *own == '\0' ? path : path + ":" + own;
}

}  // namespace

std::string Program::words() const {
  return external.worker ? fmt::format("simulator.worker = '{}'", *external.worker)
                         : fmt::format("simulator.command = '{}'", *external.command);
}

ShellCommand Program::shell_command(const std::string& text) const {
  return {text,
          external.folder,
          {{"PYTHONPATH", python_path()}, {"OMP_NUM_THREADS", std::to_string(threads)}}};
}

std::unique_ptr<ProgramCall> make_program_call(const Program& program) {
  return program.external.worker ? make_worker_call(program) : make_file_call(program);
}

}  // namespace npdr::pipeline
