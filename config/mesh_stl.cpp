// STL. Binary: 80 bytes of anything, the number of triangles, and for each a normal, three corners
// (float) and two bytes more, little endian. Ascii: of the words only "vertex x y z" and "endfacet"
// say anything. Normals are not read: the order of the corners tells the same.
#include <array>
#include <bit>

#include "config/mesh_words.h"

namespace hapticd::config {
namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i > 0; --i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return value;
}

double coordinate(std::string_view bytes, std::size_t at) {
  return static_cast<double>(std::bit_cast<float>(little_endian(bytes, at)));
}

Result<void> close_facet(SoupMaker& soup, std::size_t first) {
  const auto base = static_cast<std::int64_t>(first);
  if (soup.vertices() != first + 3)
    return refuse_mesh("expected three vertices in each facet of the STL, found " +
                       std::to_string(soup.vertices() - first) + "; export it again");
  return soup.add_polygon(std::array{base, base + 1, base + 2});
}

Result<build::TriangleSoup> parse_binary(std::string_view bytes, std::size_t max_triangles) {
  SoupMaker soup(max_triangles);
  const std::size_t count = little_endian(bytes, 80);
  if (const auto fits = soup.expect(count); !fits) return tl::unexpected(fits.error());
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = kHeader + kTriangle * t + 12 + 12 * i;
      soup.add_vertex(
          {coordinate(bytes, at), coordinate(bytes, at + 4), coordinate(bytes, at + 8)});
    }
    if (const auto added = close_facet(soup, 3 * t); !added) return tl::unexpected(added.error());
  }
  return soup.take();
}

Result<build::TriangleSoup> parse_ascii(std::string_view text, std::size_t max_triangles) {
  SoupMaker soup(max_triangles);
  std::size_t first = 0;
  for (auto word = take_word(text); !word.empty(); word = take_word(text)) {
    if (word == "endfacet") {
      if (const auto added = close_facet(soup, first); !added) return tl::unexpected(added.error());
      first = soup.vertices();
    }
    if (word != "vertex") continue;
    const auto x = real_of(take_word(text)), y = real_of(take_word(text)),
               z = real_of(take_word(text));
    if (!x || !y || !z)
      return refuse_mesh("expected three numbers after \"vertex\" number " +
                         std::to_string(soup.vertices()) + " of the STL; export it again");
    soup.add_vertex({*x, *y, *z});
  }
  if (first == 0 || soup.vertices() != first)
    return refuse_mesh("expected an STL whose facets end with \"endfacet\", found " +
                       std::to_string(first / 3) + " whole ones; is the file cut short?");
  return soup.take();
}

}  // namespace

Result<build::TriangleSoup> parse_stl(std::string_view bytes, std::size_t max_triangles) {
  const bool has_header = bytes.size() >= kHeader;
  const std::size_t wanted =
      has_header ? kHeader + kTriangle * std::size_t{little_endian(bytes, 80)} : kHeader;
  if (has_header && bytes.size() == wanted) return parse_binary(bytes, max_triangles);
  if (bytes.starts_with("solid")) return parse_ascii(bytes, max_triangles);
  return refuse_mesh("expected an STL: text that begins with \"solid\", or " +
                     std::to_string(wanted) + " bytes as its header says; found " +
                     std::to_string(bytes.size()) + " bytes; export or copy it again");
}

}  // namespace hapticd::config
