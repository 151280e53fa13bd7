// Errors of a config file, all at once, each with its place.
#pragma once
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "control/core/result.h"

namespace hapticd::config {

struct ConfigError {
  std::string file{};
  int line = 0;           ///< from 1; 0: the file as a whole
  int column = 0;         ///< from 1
  std::string path{};     ///< "devices[0].axes[1].encoder.bits"
  std::string message{};  ///< what was expected, what was found, what to do
  ExitCode code =
      ExitCode::bad_data;  ///< no_input, no_permission where the file could not be read at all
};

/// "file:line:column: path: message"
std::string to_string(const ConfigError& error);

template <class T>
using Checked = tl::expected<T, std::vector<ConfigError>>;

}  // namespace hapticd::config
