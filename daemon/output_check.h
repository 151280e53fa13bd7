// Before long work: can its files be written at its end? What cannot be told beforehand (a disk that fills) is told then.
#pragma once
#include <initializer_list>
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

/// `output` can be written by replace_file(), and is none of the files that are read. Errors: usage (it is one of them,
/// or "-"), cannot_create, no_permission.
Result<void> check_output(const std::string& output, std::initializer_list<std::string> inputs);

/// The same of a picture; empty: none is wanted. Errors: usage (neither .png nor .svg), unavailable (no gnuplot).
Result<void> check_picture(const std::string& picture, std::initializer_list<std::string> inputs);

/// How a config names a file: relative to the config's own directory, if it is not absolute.
std::string named_from(const std::string& config, const std::string& file);

}  // namespace hapticd::daemon
