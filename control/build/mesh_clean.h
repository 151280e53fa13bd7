// First steps from a soup to a mesh: checked, welded, without triangles that are none.
#pragma once
#include <string>
#include <vector>

#include "control/build/mesh.h"

namespace hapticd::build {

/// Errors: vertex not finite, index out of range, no triangle left. Repairs are appended.
Result<TriangleSoup> clean(TriangleSoup soup, std::vector<std::string>& repairs);

/// "(0.01, 0.02, 0) m"
std::string place_text(const Vec3& place);
/// "1 triangle", "2 triangles"
std::string count_text(std::size_t count, const std::string& thing);

}  // namespace hapticd::build
