// Normal noise that is the same on every machine: integers from std::mt19937_64 (fixed by the C++
// standard), summed. std::normal_distribution, and anything with log or cos, differs between
// libraries.
#pragma once
#include <cstddef>
#include <cstdint>
#include <random>

namespace hapticd::sim {

class Noise {
 public:
  /// Streams of one seed are independent of each other.
  Noise(std::uint64_t seed, std::size_t stream) noexcept : engine_(mixed(seed, stream)) {}

  /// Mean 0, standard deviation 1: the sum of twelve uniform numbers of 16 bits, so never beyond 6.
  double normal() noexcept {
    std::int64_t sum = 0;
    for (int draw = 0; draw < 3; ++draw) {
      std::uint64_t bits = engine_();
      for (int part = 0; part < 4; ++part, bits >>= 16)
        sum += static_cast<std::int64_t>(bits & 0xffff);
    }
    return (static_cast<double>(sum) - 12 * 32767.5) / 65536;
  }

 private:
  // splitmix64 (Steele, Lea, Flood 2014): neighbouring seeds and streams end far apart.
  static std::uint64_t mixed(std::uint64_t seed, std::size_t stream) noexcept {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15 * (static_cast<std::uint64_t>(stream) + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
};

}  // namespace hapticd::sim
