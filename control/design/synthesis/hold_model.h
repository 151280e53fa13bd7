// Models in continuous time of the zero-order hold that a command goes through, and what each makes
// of the wall's controller. Eom, Suh and Yi say only that the hold is a low-pass of gain 1 at rest
// and 90 degrees of lag at the Nyquist frequency; each reading of that is a model here.
//
//   none             1
//   adams_hannaford  the device by Tustin's rule, the hold (z + 1)/(2 z), the wall's spring by backward
//                    differences: with s = (2/T)(z - 1)/(z + 1) the hold is 1/(1 + s T/2) and the spring
//                    K T z/(z - 1) is K/s + K T/2, so that B_c grows by K T/2 (Adams, Hannaford 1999)
//   first_order      1/(1 + s/w), w = 2/T unless given
//   second_order     1/(1 + 2 zeta s/w + (s/w)^2), w = pi/T unless given: 90 degrees at Nyquist
//   zero_order       (1 - e^{-sT})/(sT), the hold as it is between aliases
//   delay            e^{-sT/2}
//   average          (1 + e^{-sT})/2: 90 degrees at Nyquist
//
// All have size <= 1 in the right half-plane but second_order with zeta below 0.707.
#pragma once
#include <cstdint>
#include <optional>

#include "control/design/synthesis/rational.h"

namespace hapticd::synthesis {

enum class Hold : std::uint8_t {
  none,
  adams_hannaford,
  first_order,
  second_order,
  zero_order,
  delay,
  average
};

struct HoldModel {
  Hold kind = Hold::adams_hannaford;
  double corner_rad_s = 0;        ///< w of first_order and second_order; 0: as above
  double damping_ratio = 0.7071;  ///< zeta of second_order, > 0
};

Complex at(const HoldModel& hold, Complex s, double period_s);
/// Nothing where the model is no quotient of polynomials.
std::optional<Rational> rational(const HoldModel& hold, double period_s);
/// What the model adds to B_c, N s/m.
double added_damper(const HoldModel& hold, double stiffness, double period_s);

}  // namespace hapticd::synthesis
