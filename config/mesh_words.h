// What the readers of mesh files share: lines, words, numbers, polygons.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "control/build/mesh.h"

namespace hapticd::config {

/// Takes the next line, without its end, off `text`.
std::string_view take_line(std::string_view& text);
/// Takes the next word off `text`, over ends of lines too; empty: there is none.
std::string_view take_word(std::string_view& text);
/// A whole word as a number, in any locale; nothing: it is none.
std::optional<double> real_of(std::string_view word);
std::optional<std::int64_t> integer_of(std::string_view word);
/// The beginning of a piece of text, fit for a message.
std::string printable(std::string_view text);

tl::unexpected<Error> refuse_mesh(std::string text);

/// Collects triangles, up to a number.
class SoupMaker {
 public:
  explicit SoupMaker(std::size_t max_triangles) : max_triangles_(max_triangles) {}
  void add_vertex(const Vec3& vertex) { soup_.vertices.push_back(vertex); }
  std::size_t vertices() const { return soup_.vertices.size(); }
  /// Refuses `found` triangles if they are too many.
  Result<void> expect(std::size_t found) const;
  /// Cuts it into a fan; of fewer than three corners nothing is left. Errors: too many triangles, a
  /// vertex that does not exist (yet), a polygon so bent inwards that triangles fold back.
  Result<void> add_polygon(std::span<const std::int64_t> corners);
  build::TriangleSoup take() { return std::move(soup_); }

 private:
  std::size_t max_triangles_;
  build::TriangleSoup soup_;
};

/// Each reads the bytes of a whole file.
Result<build::TriangleSoup> parse_stl(std::string_view bytes, std::size_t max_triangles);
Result<build::TriangleSoup> parse_obj(std::string_view text, std::size_t max_triangles);
Result<build::TriangleSoup> parse_ply(std::string_view bytes, std::size_t max_triangles);

}  // namespace hapticd::config
