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

  bool permits(bool unproven) const noexcept {
    return answer == Answer::open || (answer == Answer::needs_unproven && unproven);
  }
  bool proved() const noexcept;
  /// The verdict and, line by line, why each device is proved or not.
  std::string explanation() const;
};

/// Computes the answer for a compiled config; done at load and at every reload.
Gate stability_gate(const config::Compiled& compiled);
/// The rule alone.
Gate decide(config::Require require, bool only_simulated, std::vector<check::PassiveAnswer> devices,
            std::vector<std::string> names);

}  // namespace hapticd::daemon
