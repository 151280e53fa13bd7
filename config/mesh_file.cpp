#include "config/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>

#include "config/mesh_words.h"

namespace hapticd::config {
namespace {

/// A triangle of text takes some hundred bytes; more than this each is no mesh.
constexpr std::size_t kMaxBytesPerTriangle = 1024;
constexpr std::size_t kMaxOtherBytes = 1 << 20;

tl::unexpected<Error> refuse(const std::string& path, ExitCode code, const std::string& text) {
  return fail(code, path + ": " + text);
}

/// "stl" of "a/b.STL".
std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending.empty() ? ending : ending.substr(1);
}

Result<std::string> bytes_of(const std::string& path, std::size_t max_triangles) {
  std::error_code problem;
  const auto status = std::filesystem::status(path, problem);
  if (!std::filesystem::exists(status))
    return refuse(path, ExitCode::no_input, "expected a mesh file, found nothing of this name");
  if (!std::filesystem::is_regular_file(status))
    return refuse(path, ExitCode::no_input, "expected a mesh file, found no regular file");
  const auto size = std::filesystem::file_size(path, problem);
  const std::size_t most = kMaxOtherBytes + kMaxBytesPerTriangle * max_triangles;
  if (!problem && size > most)
    return refuse(path, ExitCode::bad_data,
                  "expected at most " + std::to_string(most) +
                      " bytes for max_triangles = " + std::to_string(max_triangles) + ", found " +
                      std::to_string(size) + "; simplify the mesh, or raise max_triangles");
  std::ifstream file(path, std::ios::binary);
  std::string bytes(problem ? 0 : static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file || problem)
    return refuse(path, ExitCode::no_permission, "cannot read this file; ls -l shows who may");
  return bytes;
}

Result<build::TriangleSoup> parse(const std::string& ending, const std::string& bytes,
                                  std::size_t max_triangles) {
  if (ending == "stl") return parse_stl(bytes, max_triangles);
  if (ending == "obj") return parse_obj(bytes, max_triangles);
  if (ending == "ply") return parse_ply(bytes, max_triangles);
  return refuse_mesh("expected a name that ends in .stl, .obj or .ply, found \"." + ending +
                     "\"; export the mesh as one of these");
}

}  // namespace

Result<build::TriangleSoup> read_mesh(const std::string& path, std::size_t max_triangles) try {
  const auto bytes = bytes_of(path, max_triangles);
  if (!bytes) return tl::unexpected(bytes.error());
  auto soup = parse(ending_of(path), *bytes, max_triangles);
  if (!soup) return refuse(path, soup.error().code, soup.error().text);
  return soup;
} catch (const std::exception& error) {
  return refuse(path, ExitCode::bad_data, "cannot make a mesh of it: " + std::string(error.what()));
}

}  // namespace hapticd::config
