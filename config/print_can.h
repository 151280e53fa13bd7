// CAN drives and buses as text; part of config/print.h.
#pragma once
#include <string>

#include "config/compile.h"

namespace hapticd::config {

/// Of a device: where its drives are, when they measure, how old a sample may be; empty: it has none.
std::string drives_text(const Compiled& compiled, std::size_t device);

/// One line for each bus: how much of its time is used at worst, how many axes fit.
std::string buses_text(const Compiled& compiled);

}  // namespace hapticd::config
