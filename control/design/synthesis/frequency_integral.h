// The integral over all frequencies w >= 0 of a pair of smooth functions that fall off as 1/w^2:
// w = unit tan(phi), and adaptive Gauss-Kronrod of 7 and 15 points over phi (QUADPACK, 1983).
#pragma once
#include <Eigen/Core>
#include <functional>

namespace hapticd::synthesis {

/// `unit` rad/s: where most of it is. Halved until the rules of 7 and 15 points agree to 1e-7 of the
/// first function's integral, which is >= 0; what is returned is that of 15.
Eigen::Vector2d integral_over_frequency(const std::function<Eigen::Vector2d(double)>& function,
                                        double unit);

}  // namespace hapticd::synthesis
