// Frequency response between two signals, as measured: delay and hold included.
//
// Over stretches i (blocks of whole periods of a stepped sine, or Hann windows of a chirp), with Y_i
// and U_i the complex amplitudes of output and input,
//
//   response  H = sum Y_i U_i* / sum |U_i|^2
//   coherence   = |sum Y_i U_i*|^2 / (sum |Y_i|^2 sum |U_i|^2)
//
// (Bendat, Piersol, Random Data, 4th ed., 6.2): 1 where all of the output follows from the input,
// less where noise or anything else has a part in it. One stretch alone always says 1.
#pragma once
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "control/identify/excitation.h"
#include "control/identify/record.h"

namespace hapticd::identify {

struct ResponsePoint {
  double frequency_Hz = 0;
  std::complex<double> response{};  ///< output per input
  double coherence = 0;             ///< 0 to 1; 0 too where nothing moved
  double output = 0;                ///< amplitude, root mean square over the stretches
  double input = 0;                 ///< likewise
  int stretches = 0;
};

/// A value a tick.
using Signal = std::vector<double>;
Signal positions(const Record& record);
Signal efforts(const Record& record);

/// At each frequency of a stepped sine.
std::vector<ResponsePoint> stepped_response(const Signal& output, const Signal& input,
                                            std::span<const Measured> measured);

/// Of a chirp, at `points` frequencies between the two, by equal ratios.
struct ChirpGrid {
  double low_Hz = 0, high_Hz = 0;
  int points = 0;
  double period_s = 0;
};
std::vector<ResponsePoint> chirp_response(const Signal& output, const Signal& input,
                                          const ChirpGrid& grid);

/// Complex amplitude of the sine with `cycles` periods in the values: Re(y e^{2 pi i n cycles / N}) and
/// a straight line, fitted together, for a line is not orthogonal to a few periods of a sine. `hann`:
/// weighted by a Hann window.
std::complex<double> coefficient(std::span<const double> values, double cycles, bool hann);

/// Block number `block`, empty where the signal is too short.
std::span<const double> block_of(const Signal& signal, const Measured& measured, int block);

}  // namespace hapticd::identify
