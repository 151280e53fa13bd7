// YAML text -> a small tree that knows where everything stood. The only place that sees yaml-cpp.
//
// What a config must not use is refused here, with its place: anchors, aliases, tags, duplicate
// keys, keys that are not plain text, a second document, deep nesting; and before the parser sees
// the text: bytes that are not UTF-8, control characters, tabs as indentation.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "config/error.h"
#include "config/places.h"

namespace hapticd::config {

/// Longest text that is parsed.
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;
/// Errors of one file beyond this are of no help to anybody.
inline constexpr std::size_t kMaxErrors = 200;
/// Deepest nesting; a config needs 8.
inline constexpr int kMaxDepth = 32;

struct YamlKey {
  std::string text;
  Mark mark;
};

/// `refused`: an error says already what is wrong with it.
enum class NodeKind { null, scalar, sequence, map, refused };

struct Node {
  NodeKind kind = NodeKind::null;
  Mark mark{};
  std::string text{};           ///< of a scalar
  bool quoted = false;          ///< of a scalar: in quotes or as a block, so never a number
  std::vector<Node> items{};    ///< of a sequence, or the values of a map
  std::vector<YamlKey> keys{};  ///< of a map, as long as `items`
};

/// The value of a key; nullptr: the map has no such key.
const Node* find(const Node& map, const std::string& key);

/// What became of a text.
struct YamlText {
  bool sound = false;  ///< the syntax is, so that `root` is worth reading in spite of `errors`
  Node root;
  std::vector<ConfigError> errors;
};

/// Parses one document; errors name `file`.
YamlText parse_yaml(const std::string& text, const std::string& file);

}  // namespace hapticd::config
