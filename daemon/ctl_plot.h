// `hapticctl plot FILE`: a picture of a recording or of CSV curves.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/plot.h"

namespace hapticd::daemon {

// What the command line says of a picture; "" or what was expected instead.
std::string set_size(PlotOptions& options, const std::string& size);      ///< "1200x800"
std::string set_log_axes(PlotOptions& options, const std::string& axes);  ///< "x", "y", "xy"

/// Draws it and prints what was drawn.
ExitCode run_plot(const std::string& path, const PlotOptions& options, bool json);

}  // namespace hapticd::daemon
