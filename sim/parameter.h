/// A physics parameter of a simulator that inference can be about.
#pragma once

#include <string>

namespace npdr::sim {

/// The domain parameter's name, SI unit and nominal value, and where the model makes sense.
struct Parameter {
  std::string name;
  std::string unit;      ///< SI; "1" when dimensionless
  double nominal = 0.0;  ///< value when a study says nothing
  double lower = 0.0;    ///< smallest physically meaningful value
  double upper = 0.0;    ///< largest physically meaningful value
  std::string description;
  double period = 0.0;  ///< values this far apart are the same system; 0: none are
};

}  // namespace npdr::sim
