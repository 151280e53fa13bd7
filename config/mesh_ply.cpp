// PLY: a header in words that names elements and their properties, then the elements, one after the
// other, as text or in binary of either byte order. Wanted are x, y, z of the element "vertex" and
// the list "vertex_indices" (or "vertex_index") of the element "face"; the rest is passed over.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "config/mesh_words.h"

namespace hapticd::config {
namespace {

enum class Coding { ascii, little, big };
enum class Kind { integer, natural, real };

struct Type {
  std::string_view name, other_name;
  std::size_t bytes;
  Kind kind;
};
constexpr std::array<Type, 8> kTypes{{{"char", "int8", 1, Kind::integer},
                                      {"uchar", "uint8", 1, Kind::natural},
                                      {"short", "int16", 2, Kind::integer},
                                      {"ushort", "uint16", 2, Kind::natural},
                                      {"int", "int32", 4, Kind::integer},
                                      {"uint", "uint32", 4, Kind::natural},
                                      {"float", "float32", 4, Kind::real},
                                      {"double", "float64", 8, Kind::real}}};

const Type* type_of(std::string_view word) {
  const auto* type = std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& t) {
    return word == t.name || word == t.other_name;
  });
  return type == kTypes.end() ? nullptr : type;
}

struct Property {
  std::string_view name;
  const Type* type = nullptr;
  const Type* count = nullptr;  ///< of a list; else none
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties{};
};

struct Header {
  std::optional<Coding> coding{};
  std::vector<Element> elements{};
};

bool take_format(Header& header, std::string_view rest) {
  const std::string_view word = take_word(rest);
  if (word == "ascii") header.coding = Coding::ascii;
  if (word == "binary_little_endian") header.coding = Coding::little;
  if (word == "binary_big_endian") header.coding = Coding::big;
  return header.coding.has_value();
}

bool take_element(Header& header, std::string_view rest) {
  const std::string_view name = take_word(rest);
  const auto count = integer_of(take_word(rest));
  if (!count || *count < 0) return false;
  header.elements.push_back({.name = name, .count = static_cast<std::size_t>(*count)});
  return true;
}

bool take_property(Header& header, std::string_view rest) {
  Property property;
  std::string_view word = take_word(rest);
  if (word == "list") {
    property.count = type_of(take_word(rest));
    if (property.count == nullptr || property.count->kind == Kind::real) return false;
    word = take_word(rest);
  }
  property.type = type_of(word);
  property.name = take_word(rest);
  if (header.elements.empty() || property.type == nullptr) return false;
  header.elements.back().properties.push_back(property);
  return true;
}

/// Takes the header off `bytes`.
Result<Header> take_header(std::string_view& bytes) {
  Header header;
  if (take_line(bytes) != "ply")
    return refuse_mesh("expected a PLY, whose first line is \"ply\", found something else");
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    std::string_view rest = line;
    const std::string_view key = take_word(rest);
    if (key == "end_header" && header.coding) return header;
    const bool known = key == "comment" || key == "obj_info" ||
                       (key == "format" && take_format(header, rest)) ||
                       (key == "element" && take_element(header, rest)) ||
                       (key == "property" && take_property(header, rest));
    if (!known)
      return refuse_mesh("expected a line of a PLY header, found \"" + printable(line) +
                         "\"; export it again");
  }
  return refuse_mesh("expected a PLY header that ends with \"end_header\", found no such line");
}

/// Every element takes a byte at least.
Result<void> check(const Header& header, std::size_t bytes) {
  for (const Element& element : header.elements)
    if (element.count > bytes || (element.count > 0 && element.properties.empty()))
      return refuse_mesh("expected data for the " + std::to_string(element.count) + " elements \"" +
                         printable(element.name) + "\" that the PLY's header names, found " +
                         std::to_string(bytes) + " bytes; export or copy it again");
  return {};
}

/// Takes numbers off the data.
struct Data {
  std::string_view bytes;
  Coding coding;

  std::optional<double> take(const Type& type) {
    if (coding == Coding::ascii) return real_of(take_word(bytes));
    if (bytes.size() < type.bytes) return {};
    std::uint64_t raw = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t at = coding == Coding::big ? i : type.bytes - 1 - i;
      raw = raw << 8 | static_cast<unsigned char>(bytes[at]);
    }
    bytes.remove_prefix(type.bytes);
    return value(raw, type);
  }

 private:
  static double value(std::uint64_t raw, const Type& type) {
    if (type.kind == Kind::real)
      return type.bytes == 8
                 ? std::bit_cast<double>(raw)
                 : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    const bool negative = type.kind == Kind::integer && raw >> (8 * type.bytes - 1) != 0;
    const double wrap = negative ? static_cast<double>(std::uint64_t{1} << (8 * type.bytes)) : 0;
    return static_cast<double>(raw) - wrap;
  }
};

/// One element's worth of what is wanted.
struct Found {
  Vec3 place{};
  std::vector<std::int64_t> corners{};
};

/// A number that is no index is refused later: as one that does not exist.
std::int64_t index_of(double value) {
  return value >= 0 && value < 4294967296.0 ? static_cast<std::int64_t>(value) : -1;
}

/// False: the data ended, or is no number.
bool take_property(Data& data, const Property& property, Found& found) {
  if (property.count == nullptr) {
    const auto value = data.take(*property.type);
    if (!value) return false;
    if (property.name == "x") found.place.x = *value;
    if (property.name == "y") found.place.y = *value;
    if (property.name == "z") found.place.z = *value;
    return true;
  }
  const auto count = data.take(*property.count);
  if (!count || !(*count >= 0)) return false;
  const bool wanted = property.name == "vertex_indices" || property.name == "vertex_index";
  for (double i = 0; i < *count; ++i) {
    const auto value = data.take(*property.type);
    if (!value) return false;
    if (wanted) found.corners.push_back(index_of(*value));
  }
  return true;
}

Result<void> take_elements(Data& data, const Element& element, SoupMaker& soup) {
  Found found;
  for (std::size_t i = 0; i < element.count; ++i) {
    found.corners.clear();
    for (const Property& property : element.properties)
      if (!take_property(data, property, found))
        return refuse_mesh("expected " + std::to_string(element.count) + " elements \"" +
                           printable(element.name) + "\" in the PLY, found " + std::to_string(i) +
                           "; export or copy it again");
    if (element.name == "vertex") soup.add_vertex(found.place);
    if (element.name != "face") continue;
    if (auto added = soup.add_polygon(found.corners); !added) return added;
  }
  return {};
}

}  // namespace

Result<build::TriangleSoup> parse_ply(std::string_view bytes, std::size_t max_triangles) {
  const auto header = take_header(bytes);
  if (!header) return tl::unexpected(header.error());
  SoupMaker soup(max_triangles);
  auto good = check(*header, bytes.size());
  for (const Element& element : header->elements)
    if (good && element.name == "face") good = soup.expect(element.count);
  Data data{bytes, *header->coding};
  for (const Element& element : header->elements)
    if (good) good = take_elements(data, element, soup);
  if (!good) return tl::unexpected(good.error());
  return soup.take();
}

}  // namespace hapticd::config
