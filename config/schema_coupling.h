// The coupling between contacts and proxies, and linear systems by their matrices.
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/schema_axis.h"
#include "control/design/check/certificate_kind.h"

namespace hapticd::config {

/// By rows.
using Rows = std::vector<std::vector<double>>;

/// Stiffness or damping over some coordinates: one number for all of them, a list with one for
/// each, or a symmetric matrix.
struct Gains {
  std::variant<double, std::vector<double>, Rows> value = 0.0;
  bool operator==(const Gains&) const = default;
};

/// xi' = A xi + B u, y = C xi + D u. A, B, C may be empty: no memory.
struct StateSpace {
  Rows A, B, C, D;
  bool operator==(const StateSpace&) const = default;
};

struct CouplingBlock {
  std::vector<std::string> contacts{};  ///< "left" or "left.x"
  std::optional<Gains> stiffness_N_m{};
  Gains damping_Ns_m{};
  std::optional<StateSpace> state_space{};  ///< instead of the two
  bool operator==(const CouplingBlock&) const = default;
};

struct Solver {
  int max_sweeps = 50;
  double tolerance_N = 1e-10;
  bool operator==(const Solver&) const = default;
};

/// What a designed coupling took one device for.
struct AssumedDevice {
  std::string name;
  double latency_s = 0;
  std::vector<double> min_damping{};  ///< per axis: N s/m or N m s/rad
  std::vector<Estimator> estimators{};
  std::vector<ObserverMode> observers{};
  bool operator==(const AssumedDevice&) const = default;
};

struct Assumed {
  double rate_Hz = 1000;
  std::string scene;  ///< digest of the scene
  std::vector<AssumedDevice> devices{};
  bool operator==(const Assumed&) const = default;
};

/// control/design/check/certificate.h, as written.
struct CouplingCertificate {
  check::CertificateKind kind = check::CertificateKind::passive_closed_form;
  double damping_share = 0.98;
  Rows P_scene{}, Phi_scene{}, P_coupling{}, Delta_coupling{}, P{};
  bool operator==(const CouplingCertificate&) const = default;
};

/// A coupling file. What `hapticctl design` writes has all of it.
struct CouplingFile {
  std::vector<CouplingBlock> blocks{};
  Solver solver{};
  std::optional<Assumed> assumed{};
  std::optional<CouplingCertificate> certificate{};
  std::optional<std::string> digest{};  ///< of the other lines of the file
  bool operator==(const CouplingFile&) const = default;
};

/// In a config: the same, or the name of the file that has it.
struct Coupling {
  std::optional<std::string> file;
  std::vector<CouplingBlock> blocks{};
  Solver solver{};
  bool operator==(const Coupling&) const = default;
};

}  // namespace hapticd::config
