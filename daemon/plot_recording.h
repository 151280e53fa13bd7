// A recording as a picture.
#pragma once
#include <string>

#include "daemon/plot.h"
#include "daemon/recording.h"

namespace hapticd::daemon {

/// Over the seconds since the first record, counted in ticks. Without `fields`: position and proxy,
/// force, and effort of each device. A field is named in full ("left.x.qd") or by its end ("qd": all
/// of them in one panel). Faults are lines, limits shades.
Result<Picture> recording_picture(const Recording& recording, const std::string& path,
                                  const PlotOptions& options);
Result<Picture> recording_picture(const std::string& path, const PlotOptions& options);

}  // namespace hapticd::daemon
