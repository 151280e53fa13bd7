// CSV as a picture.
#pragma once
#include <string>
#include <string_view>

#include "daemon/plot.h"

namespace hapticd::daemon {

/// A table: the first row names its columns ("name" or "name[unit]"), the first column is x. Lines
/// that begin with # and empty lines are left out, an empty field is a gap. A column that holds words
/// labels the points. Columns of one unit share a panel; `fields` instead: a panel each.
/// `path` names it in errors and the title.
Result<Picture> csv_picture(std::string_view text, const std::string& path,
                            const PlotOptions& options);
Result<Picture> csv_picture(const std::string& path, const PlotOptions& options);

}  // namespace hapticd::daemon
