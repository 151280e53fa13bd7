#include "config/mesh_words.h"

#include <algorithm>
#include <charconv>

namespace hapticd::config {
namespace {

constexpr std::string_view kBlank = " \t\r\n\v\f";

template <class Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number = 0;
  const auto parsed = std::from_chars(word.data(), word.data() + word.size(), number);
  if (parsed.ec != std::errc{} || parsed.ptr != word.data() + word.size()) return {};
  return number;
}

}  // namespace

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view take_word(std::string_view& text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::optional<double> real_of(std::string_view word) {
  return number_of<double>(word);
}

std::optional<std::int64_t> integer_of(std::string_view word) {
  return number_of<std::int64_t>(word);
}

std::string printable(std::string_view text) {
  std::string shown(text.substr(0, 60));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

tl::unexpected<Error> refuse_mesh(std::string text) {
  return fail(ExitCode::bad_data, std::move(text));
}

Result<void> SoupMaker::expect(std::size_t found) const {
  if (found <= max_triangles_) return {};
  return refuse_mesh("expected at most max_triangles = " + std::to_string(max_triangles_) +
                     ", found " + std::to_string(found) +
                     " or more; simplify the mesh, or raise max_triangles");
}

Result<void> SoupMaker::add_polygon(std::span<const std::int64_t> corners) {
  if (corners.size() < 3) return {};
  for (const std::int64_t corner : corners)
    if (corner < 0 || corner >= static_cast<std::int64_t>(vertices()))
      return refuse_mesh("expected corners among the " + std::to_string(vertices()) +
                         " vertices, found number " + std::to_string(corner) +
                         " (counted from 0); export the mesh again");
  if (auto fits = expect(soup_.triangles.size() + corners.size() - 2); !fits) return fits;
  const auto at = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  const auto edge = [&](std::size_t i) { return soup_.vertices[at(i)] - soup_.vertices[at(0)]; };
  Vec3 first{};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 normal = cross(edge(i), edge(i + 1));
    if (first == Vec3{}) first = normal;
    if (dot(normal, first) < 0)
      return refuse_mesh("expected triangles or convex polygons, found one of " +
                         std::to_string(corners.size()) +
                         " corners that bends inwards; export triangles");
    soup_.triangles.push_back({at(0), at(i), at(i + 1)});
  }
  return {};
}

}  // namespace hapticd::config
