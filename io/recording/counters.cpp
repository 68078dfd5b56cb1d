#include "io/recording/counters.h"

#include <cmath>

namespace axisfit {

void unwrap(std::vector<double>& values, double period) {
  double before = NAN, turns = 0.0;
  for (double& x : values) {
    if (std::isnan(x)) continue;
    if (!std::isnan(before)) turns -= std::round((x - before) / period);
    before = x;
    x += turns * period;
  }
}

void restore_sign(std::vector<double>& values, int bits) {
  const double all = std::ldexp(1.0, bits);
  for (double& x : values)
    if (x >= 0.5 * all) x -= all;
}

}  // namespace axisfit
