#include "inference/estimators/estimator_config.h"

namespace npdr::inference {

std::vector<std::string> estimator_names() { return {"maf", "mdn", "nsf", "resnet"}; }

}  // namespace npdr::inference
