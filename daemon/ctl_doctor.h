// `hapticctl doctor [CONFIG]`.
#pragma once
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

struct DoctorOptions {
  std::string config;  ///< empty: the machine alone
  double seconds = 5;  ///< that the loop is watched
  int priority = 80;   ///< without a config: that the loop would have
};

/// Prints what it found and what to do. ok: nothing is bad; no: something is; else why the config
/// or its devices cannot be used.
ExitCode run_doctor(const DoctorOptions& options, bool json);

}  // namespace hapticd::daemon
