#include "pipeline/config/field_types.h"

namespace npdr::pipeline {

std::string marginal_words() {
  return "{ uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, std] } or "
         "{ log_normal = [mean of log, std of log] }, of finite numbers";
}

}  // namespace npdr::pipeline
