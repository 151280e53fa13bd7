// Coordinates of contacts by their names.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace hapticd::config {

class Compilation;

/// Of "left.x" one; of "left" all that the device has, in the order x, y, z. Empty: reported at
/// `path`. Numbers as in the plan: over all devices.
std::vector<std::uint32_t> coordinates_named(Compilation& compilation, const std::string& name,
                                             const std::string& path);

/// Of a list of names, in their order; `path` is the list's. Empty: reported, also what is named
/// twice.
std::vector<std::uint32_t> coordinates_named(Compilation& compilation,
                                             const std::vector<std::string>& names,
                                             const std::string& path);

/// Index of the device that a coordinate belongs to.
std::size_t device_of(const Compilation& compilation, std::uint32_t coordinate);

}  // namespace hapticd::config
