// What `hapticctl design` looks for, and the search.
#pragma once
#include <string>

#include "config/compile.h"
#include "control/core/result.h"

namespace hapticd::daemon {

enum class DesignStructure { decentralised, per_device, centralised };
enum class DesignFor {
  any_scene,   ///< Theorems A, A', B: closed form
  this_scene,  ///< the exact sampled test, for the linear scene of the config
  paper,       ///< Theorem 4 of the paper by cone complementarity
  robust,  ///< the damping of one wall or coupling, for the devices and hands that the config gives
};

enum class DesignAim {
  stiffest,
  transparent,  ///< least |W E V| of the scene's network, W a low-pass (section 5 of the paper)
};

struct DesignOptions {
  std::string output;
  DesignStructure structure = DesignStructure::decentralised;
  DesignFor proof = DesignFor::any_scene;
  DesignAim aim = DesignAim::stiffest;
  double corner_rad_s = 125;  ///< of W
  int order = 0;              ///< with `paper`: states of each block's V(z); 0: springs and dampers
  double damping_share = 0.98;  ///< of the device's damping that the proof may use
};

/// A coupling for the config of the document, with what it assumes and what proves it; the config's
/// own coupling is not read. Nothing of it is believed yet: the daemon's check has to be asked.
/// Errors: `no` where there is none, bad_data.
Result<config::CouplingFile> design_coupling(config::Document document,
                                             const DesignOptions& options);

}  // namespace hapticd::daemon
