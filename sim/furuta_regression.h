/// The Furuta pendulum's equations of motion as a linear regression: Appendix B of the paper.
///
/// Two rows for each state of a recording; with arm and pole angle (p, a), velocities (p', a'),
/// accelerations (p", a"), s = sin a and c = cos a,
///   [ p"   p" s^2 + 2 p' a' s c   a" c - a'^2 s   0   p'   0  ]
///   [ 0    4/3 a" - p'^2 s c      p" c            s   0    a' ]
/// times w = (w0, ..., w5) of eq. (2) is (tau, 0), and w gives back
///   L_r = w2 g / w3,   L_p = 2 w1 g / w3,   M_p = w3^2 / (w1 g^2),
///   M_r = 12 M_p (w0 w1 / w2^2 - 1),   D_p = w5,   D_r = w4 - k_m^2 / R_m.
/// Known are k_m, R_m and g, without which w has no unique solution, and the six parameters beyond
/// the paper: tau = gamma u - coulomb_friction tanh(p' / 0.3) - cable_stiffness (p -
/// cable_rest_angle), u the voltage after delay, saturation and dead zone (furuta.h).
///
/// Accelerations are slopes of the recorded velocities, angles and velocities are smoothed, both by
/// the same local cubic polynomials (savitzky_golay.h). A slope over a window answers to all
/// voltages that were held inside of it, so u is their average by the same weights; the voltage of
/// the one step after a state would lag behind by half a step.
#pragma once

#include "sim/furuta.h"
#include "sim/regression_form.h"

namespace npdr::sim {

class FurutaRegression final : public RegressionForm {
 public:
  std::vector<Index> identified() const override;
  RegressionRows rows(const Target& target, const Vector& known, Index window) const override;
  Vector recover(const Vector& w, const Vector& known) const override;

 private:
  Index position(const char* name) const { return parameter_index(model_.info(), name); }
  Vector applied_voltages(const Rollout& rollout, const Vector& known) const;

  Furuta model_;
};

}  // namespace npdr::sim
