// OBJ: lines "v x y z" and "f a b c ...", where a corner is a number of a vertex, from 1, or from
// the last one backwards if negative, and whatever follows a slash is not ours. All other lines are
// about looks.
#include <vector>

#include "config/mesh_words.h"

namespace hapticd::config {
namespace {

/// From 0; nothing: the word is no corner.
std::optional<std::int64_t> corner_of(std::string_view word, std::size_t vertices) {
  const auto number = integer_of(word.substr(0, word.find('/')));
  if (!number || *number == 0) return {};
  return *number > 0 ? *number - 1 : static_cast<std::int64_t>(vertices) + *number;
}

tl::unexpected<Error> refuse_line(std::size_t number, std::string_view line) {
  return refuse_mesh("line " + std::to_string(number) + ": expected \"v x y z\" or \"f a b c\", " +
                     "found \"" + printable(line) + "\"; export the mesh again");
}

}  // namespace

Result<build::TriangleSoup> parse_obj(std::string_view text, std::size_t max_triangles) {
  SoupMaker soup(max_triangles);
  std::vector<std::int64_t> corners;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    std::string_view rest = line;
    const std::string_view key = take_word(rest);
    if (key == "v") {
      const auto x = real_of(take_word(rest)), y = real_of(take_word(rest)),
                 z = real_of(take_word(rest));
      if (!x || !y || !z) return refuse_line(number, line);
      soup.add_vertex({*x, *y, *z});
    } else if (key == "f") {
      corners.clear();
      for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
        const auto corner = corner_of(word, soup.vertices());
        if (!corner) return refuse_line(number, line);
        corners.push_back(*corner);
      }
      if (const auto added = soup.add_polygon(corners); !added)
        return refuse_mesh("line " + std::to_string(number) + ": " + added.error().text);
    }
  }
  build::TriangleSoup made = soup.take();
  if (!made.triangles.empty()) return made;
  return refuse_mesh("expected an OBJ with faces (lines \"f 1 2 3\"), found none");
}

}  // namespace hapticd::config
