// Whether forces may be enabled: `stability.require` held against what is proved. Pure.
#pragma once
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/design/check/stability.h"

namespace hapticd::daemon {

struct Gate {
  enum class Answer {
    open,            ///< forces may be enabled
    needs_unproven,  ///< only with `hapticctl enable --unproven`
    closed,          ///< not with this config
  };
  Answer answer = Answer::closed;
  std::string verdict;  ///< one sentence, with what to do where the gate is not open
  std::vector<check::PassiveAnswer> devices;  ///< in plan order
  std::vector<std::string> names;
  std::string certificate_problem{};  ///< why the coupling file's certificate does not count

  /// Of one device, where stability.require is robust.
  struct Robust {
    bool proved = false;
    std::string why;
  };
  std::vector<Robust> robust{};  ///< in plan order; empty: not asked for

  bool permits(bool unproven) const noexcept {
    return answer == Answer::open || (answer == Answer::needs_unproven && unproven);
  }
  /// Passive, every device.
  bool proved() const noexcept;
  /// Every device passive or robust, where that was asked for.
  bool proved_robust() const noexcept;
  /// The verdict and, line by line, why each device is proved or not.
  std::string explanation() const;
};

/// Computes the answer for a compiled config; done at load and at every reload.
Gate stability_gate(const config::Compiled& compiled);
/// The rule alone.
Gate decide(config::Require require, bool only_simulated, std::vector<check::PassiveAnswer> devices,
            std::vector<std::string> names, std::vector<Gate::Robust> robust = {});

}  // namespace hapticd::daemon
