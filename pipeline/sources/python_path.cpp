#include "pipeline/sources/python_path.h"

#include <cstdlib>

#include "pipeline/process/child_process.h"

namespace npdr::pipeline {

std::string python_path() {
  std::string path = (executable_folder().parent_path() / "lib").string();
  if (const char* const own = std::getenv("PYTHONPATH"); own != nullptr && *own != '\0') {
    path += std::string(":") + own;
  }
  return path;
}

}  // namespace npdr::pipeline
