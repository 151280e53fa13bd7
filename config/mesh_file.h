// Triangles from files: STL (ascii and binary), OBJ, PLY (ascii and binary); told apart by the
// ending of the name. Formats hold no unit; coordinates are as in the file.
//
// Read by hand and not by a library: of a mesh three lists of numbers are wanted, and what Debian
// has for it (assimp 5.2) ends the program on files with a broken byte in a comment.
#pragma once
#include <cstddef>
#include <string>

#include "control/build/mesh.h"

namespace hapticd::config {

/// Polygons are cut into triangles; what is no surface (points, lines, colours, materials) is left
/// out. The size of the file and the numbers in its header are checked before anything is made of
/// them. Errors name the file, and say what was expected and found and what to do; any bytes end in
/// triangles or an error.
Result<build::TriangleSoup> read_mesh(const std::string& path, std::size_t max_triangles);

}  // namespace hapticd::config
