// Which devices feel each other: those that a block of the coupling or a network ties together.
#pragma once
#include <cstddef>
#include <vector>

namespace hapticd::config {

class Compilation;

/// Per device the number of its group: the same for all that are tied, directly or through others.
std::vector<std::size_t> device_groups(const Compilation& compilation);

}  // namespace hapticd::config
