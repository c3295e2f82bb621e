#include "inference/estimators/estimator_config.h"

namespace npdr::inference {

std::vector<std::string> estimator_names() { return {"maf", "mdn", "nsf"}; }

}  // namespace npdr::inference
