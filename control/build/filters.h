// Coefficients of the velocity estimators and of the observer from figures that people think in.
// Made at set-up; ranges are checked by config/, here they are premises.
#pragma once
#include <cstdint>

#include "control/motion/estimators.h"
#include "control/observer/observer.h"

namespace hapticd::build {

/// a = 1 - exp(-2 pi f_c T), in (0, 1): a first-order lag that is exact at the ticks for an input
/// that is held between them. cutoff_Hz > 0.
double low_pass_share(double cutoff_Hz, double period_s) noexcept;

control::LowPassPlan low_pass(std::uint16_t axis, double cutoff_Hz, double period_s) noexcept;

/// Slope at the newest of `window` positions of the polynomial of `degree` that fits them best.
/// 1 <= degree < window <= kMaxWindow. May allocate.
control::LeastSquaresPlan least_squares(std::uint16_t axis, std::uint16_t window,
                                        std::uint16_t degree, double period_s);

/// `noise`: m or rad, half-width of the band; one encoder count for a quantiser that rounds down.
/// The band is widened by 1e-9 of itself: a position on its edge is in it, whatever the rounding.
control::FoawPlan foaw(std::uint16_t axis, std::uint16_t window, double noise) noexcept;

/// bandwidth_rad_s = w > 0: three poles at exp(-w T).
control::AlphaBetaGammaPlan alpha_beta_gamma(std::uint16_t axis, double bandwidth_rad_s,
                                             double period_s) noexcept;

enum class ObserverMode : std::uint8_t { model, sensor, classic };

/// An observer in physical figures. For a rotary axis read N m s/rad for N s/m, kg m^2 for kg.
struct ObserverFigures {
  ObserverMode mode = ObserverMode::model;
  double nominal_mass_kg = 0;       ///< m_n: how the axis is to feel
  double nominal_damping_Ns_m = 0;  ///< b_n
  double mass_kg = 0;               ///< what the axis is believed to be (`model` only)
  double damping_Ns_m = 0;          ///< likewise
  double cutoff_Hz = 0;             ///< of each lag, > 0
  int order = 2;                    ///< 1 or 2 equal lags
  std::uint16_t delay_ticks = 0;    ///< whole ticks from command to force, at most kMaxDelayTicks
  double blend_s = 0;               ///< from a cold start to the full output, >= 0
  double max_output = 0;            ///< N or N m, > 0
};

/// `source`: axis or contact coordinate; `device`: whose it is.
control::ObserverPlan observer(std::uint16_t source, std::uint16_t device,
                               const ObserverFigures& figures, double period_s) noexcept;

}  // namespace hapticd::build
