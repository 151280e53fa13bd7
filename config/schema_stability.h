// What is demanded of the scene before forces come on, and what the answers to it go by.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "config/schema_coupling.h"

namespace hapticd::config {

enum class Require { passive, robust, none };

/// Low and high.
using Range = std::array<double, 2>;

/// What a hand adds to the axis that it holds.
struct HandRange {
  Range mass_kg{}, damping_Ns_m{}, stiffness_N_m{};
  bool operator==(const HandRange&) const = default;
};

/// control/design/synthesis/hold_model.h.
enum class HoldKind {
  none,
  adams_hannaford,
  first_order,
  second_order,
  zero_order,
  delay,
  average
};
/// What Eom, Suh and Yi leave open.
struct PaperModel {
  HoldKind hold = HoldKind::adams_hannaford;
  std::optional<double> corner_rad_s{};
  double damping_ratio = 0.7071;
  std::vector<double> weight_numerator{100};  ///< ascending powers of s
  std::vector<double> weight_denominator{100, 1};
  bool operator==(const PaperModel&) const = default;
};

struct Stability {
  Require require = Require::passive;
  std::optional<HandRange> hand{};     ///< null: no hand
  std::optional<std::string> proof{};  ///< a file of ProofFile
  PaperModel paper{};
  bool operator==(const Stability&) const = default;
};

/// Quadratic Lyapunov functions z' P z of the loop of one device (control/design/check/common_lyapunov.h).
struct DeviceProof {
  std::string device;
  std::vector<Rows> P{};
  bool operator==(const DeviceProof&) const = default;
};
/// What `hapticctl certify -o` writes.
struct ProofFile {
  std::vector<DeviceProof> devices{};
  bool operator==(const ProofFile&) const = default;
};

}  // namespace hapticd::config
