// Names for files that are never overwritten.
#pragma once
#include <string>

#include "daemon/recording.h"

namespace hapticd::daemon {

/// Now, as 20261122T175600Z.
std::string utc_stamp();

/// Creates <stem><suffix>, or <stem>-2<suffix> and so on where that exists already.
Result<RecordingWriter> create_unique(const std::string& stem, const std::string& suffix,
                                      const RecordingHeader& header);

/// Creates `path`, or where it exists the same name with the time before its suffix.
Result<RecordingWriter> create_beside(const std::string& path, const RecordingHeader& header);

}  // namespace hapticd::daemon
