#include "control/identify/response.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::identify {
namespace {

constexpr double kPeriodsInWindow = 6;  // of a chirp, at the lowest frequency at most

/// Sums over stretches.
class Averages {
 public:
  void add(std::complex<double> output, std::complex<double> input) {
    cross_ += output * std::conj(input);
    output_ += std::norm(output);
    input_ += std::norm(input);
    ++count_;
  }
  ResponsePoint point(double frequency_Hz) const {
    ResponsePoint point{.frequency_Hz = frequency_Hz, .stretches = count_};
    if (output_ == 0 || input_ == 0) return point;
    point.response = cross_ / input_;
    point.coherence = std::norm(cross_) / (output_ * input_);
    point.output = std::sqrt(output_ / count_);
    point.input = std::sqrt(input_ / count_);
    return point;
  }

 private:
  std::complex<double> cross_;
  double output_ = 0, input_ = 0;
  int count_ = 0;
};

Signal signal_of(const Record& record, double Sample::*value) {
  Signal all;
  all.reserve(record.samples.size());
  for (const Sample& sample : record.samples) all.push_back(sample.*value);
  return all;
}

}  // namespace

Signal positions(const Record& record) {
  return signal_of(record, &Sample::position);
}
Signal efforts(const Record& record) {
  return signal_of(record, &Sample::effort);
}

std::complex<double> coefficient(std::span<const double> values, double cycles, bool hann) {
  const auto count = static_cast<double>(values.size());
  const double turn = 2 * std::numbers::pi / count;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t n = 0; n < values.size(); ++n) {
    const auto at = static_cast<double>(n);
    const double weight = hann ? 1 - std::cos(turn * (at + 0.5)) : 1;
    const Eigen::Vector4d row(std::cos(turn * cycles * at), std::sin(turn * cycles * at), 1,
                              at / count - 0.5);
    normal += weight * row * row.transpose();
    right += weight * (values[n] - values[0]) * row;
  }
  const Eigen::Vector4d found = normal.ldlt().solve(right);
  return {found(0), -found(1)};
}

std::span<const double> block_of(const Signal& signal, const Measured& measured, int block) {
  const std::size_t begin = measured.begin + static_cast<std::size_t>(block) * measured.block_ticks;
  if (begin + measured.block_ticks > signal.size()) return {};
  return std::span(signal).subspan(begin, measured.block_ticks);
}

std::vector<ResponsePoint> stepped_response(const Signal& output, const Signal& input,
                                            std::span<const Measured> measured) {
  std::vector<ResponsePoint> points;
  for (const Measured& at : measured) {
    Averages averages;
    for (int block = 0; block < at.blocks; ++block) {
      const auto y = block_of(output, at, block), u = block_of(input, at, block);
      if (y.empty() || u.empty()) break;
      averages.add(coefficient(y, at.periods, false), coefficient(u, at.periods, false));
    }
    points.push_back(averages.point(at.frequency_Hz));
  }
  return points;
}

std::vector<ResponsePoint> chirp_response(const Signal& output, const Signal& input,
                                          const ChirpGrid& grid) {
  const std::size_t samples = std::min(output.size(), input.size());
  const auto length = std::min(
      samples / 4,
      static_cast<std::size_t>(std::ceil(kPeriodsInWindow / (grid.low_Hz * grid.period_s))));
  std::vector<ResponsePoint> found;
  for (int i = 0; i < grid.points; ++i) {
    const double share = static_cast<double>(i) / std::max(1, grid.points - 1);
    const double frequency_Hz = grid.low_Hz * std::pow(grid.high_Hz / grid.low_Hz, share);
    const double cycles = frequency_Hz * grid.period_s * static_cast<double>(length);
    Averages averages;
    for (std::size_t at = 0; length > 1 && at + length <= samples; at += length / 2) {
      averages.add(coefficient(std::span(output).subspan(at, length), cycles, true),
                   coefficient(std::span(input).subspan(at, length), cycles, true));
    }
    found.push_back(averages.point(frequency_Hz));
  }
  return found;
}

}  // namespace hapticd::identify
