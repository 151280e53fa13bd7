#include "control/design/synthesis/frequency_integral.h"

#include <array>
#include <cmath>

namespace hapticd::synthesis {
namespace {

using Pair = Eigen::Vector2d;
using Function = std::function<Pair(double)>;

// Nodes from the outside in; those of odd number are Gauss's.
constexpr std::array<double, 8> kNodes = {
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693800, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0};
constexpr std::array<double, 8> kKronrod = {
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> kGauss = {
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

struct Estimate {
  Pair value;
  double error;
};

Estimate over(const Function& f, double low, double high) {
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  Pair fine = kKronrod[7] * f(middle), coarse = kGauss[3] / kKronrod[7] * fine;
  for (std::size_t i = 0; i < 7; ++i) {
    const Pair both = f(middle - half * kNodes[i]) + f(middle + half * kNodes[i]);
    fine += kKronrod[i] * both;
    if (i % 2 == 1) coarse += kGauss[i / 2] * both;
  }
  return {half * fine, half * (fine - coarse).lpNorm<Eigen::Infinity>()};
}

Pair refined(const Function& f, double low, double high, const Estimate& known, double tolerance,
             int halvings) {
  if (known.error <= tolerance || halvings == 0) return known.value;
  const double middle = 0.5 * (low + high);
  return refined(f, low, middle, over(f, low, middle), 0.5 * tolerance, halvings - 1) +
         refined(f, middle, high, over(f, middle, high), 0.5 * tolerance, halvings - 1);
}

}  // namespace

Pair integral_over_frequency(const Function& function, double unit) {
  constexpr double kTolerance = 1e-7;  // of the coarse rule; the fine one is far better
  constexpr int kFirst = 8, kHalvings = 25;
  const double right = 0.5 * std::acos(-1.0);
  const auto mapped = [&](double phi) -> Pair {
    const double tangent = std::tan(phi);
    return unit * (1 + tangent * tangent) * function(unit * tangent);
  };
  Pair sum = Pair::Zero();
  std::array<Estimate, kFirst> pieces;
  for (int i = 0; i < kFirst; ++i) {
    pieces[static_cast<std::size_t>(i)] =
        over(mapped, right * i / kFirst, right * (i + 1) / kFirst);
    sum += pieces[static_cast<std::size_t>(i)].value;
  }
  const double tolerance = kTolerance * sum[0] / kFirst;
  Pair total = Pair::Zero();
  for (int i = 0; i < kFirst; ++i)
    total += refined(mapped, right * i / kFirst, right * (i + 1) / kFirst,
                     pieces[static_cast<std::size_t>(i)], tolerance, kHalvings);
  return total;
}

}  // namespace hapticd::synthesis
