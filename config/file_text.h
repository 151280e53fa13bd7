// Files as text.
#pragma once
#include <string>

#include "config/error.h"

namespace hapticd::config {

/// The text of a file; of one that is too long for YAML (yaml_tree.h), just enough to see that.
/// Pipes are read as well.
Checked<std::string> file_text(const std::string& path);

}  // namespace hapticd::config
