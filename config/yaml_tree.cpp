#include "config/yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <sstream>
#include <utility>

#include "config/text_check.h"

namespace hapticd::config {
namespace {

/// Thrown by the handler through the parser: nothing after it is worth reading.
struct Stop {};

Mark to_mark(const YAML::Mark& mark) {
  return {mark.line + 1, mark.column + 1};
}

/// Builds the tree from the parser's events.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) {
      refuse(
          to_mark(mark),
          "a second document starts here; a config is one document, remove '---' and what follows");
      throw Stop{};
    }
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    const bool written =
        mark.pos >= 0 && static_cast<std::size_t>(mark.pos) < text_.size() && is_null_word(mark);
    // A value left out has no place of its own: the parser names the next one.
    const bool sound = !written || check_properties(mark, "?");
    place(Node{.kind = sound ? NodeKind::null : NodeKind::refused,
               .mark = written ? to_mark(mark) : place_of_empty(mark)});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(to_mark(mark), "alias ('*name'); write the value out, one line says one thing here");
    place(Node{.kind = NodeKind::refused, .mark = to_mark(mark)});
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    const bool sound = check_properties(mark, tag);
    place(Node{.kind = sound ? NodeKind::scalar : NodeKind::refused,
               .mark = to_mark(mark),
               .text = value,
               .quoted = tag != "?"});
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, NodeKind::sequence);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, NodeKind::map);
  }
  void OnMapEnd() override { close(); }

  void refuse(Mark mark, std::string message) {
    if (errors.size() >= kMaxErrors) return;  // a file of commas only could name a million
    errors.push_back(
        {.file = file_, .line = mark.line, .column = mark.column, .message = std::move(message)});
  }
  bool any_document() const { return documents_ > 0; }

  Node root;
  std::vector<ConfigError> errors;

 private:
  /// A map or sequence whose end has not come yet.
  struct Open {
    Node node;
    YamlKey key{};  ///< of the map entry whose value comes next
    bool has_key = false;
    bool drop_value = false;             ///< the key was refused, so its value goes nowhere
    std::map<std::string, int> lines{};  ///< of the keys so far
  };

  char at(const YAML::Mark& mark) const {
    // The parser strips a byte order mark and does not count it.
    const std::size_t skipped = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    const std::size_t position = static_cast<std::size_t>(mark.pos) + skipped;
    return position < text_.size() ? text_[position] : '\0';
  }
  bool is_null_word(const YAML::Mark& mark) const {
    const char c = at(mark);
    if (c != '~' && c != 'n' && c != 'N') return false;
    return open_.empty() || !open_.back().has_key ||
           to_mark(mark).line == open_.back().key.mark.line;
  }
  Mark place_of_empty(const YAML::Mark& mark) const {
    const bool is_value = !open_.empty() && open_.back().has_key;
    return is_value ? open_.back().key.mark : to_mark(mark);
  }

  /// Tags and anchors. The parser does not tell "!" from quotes, so the text itself is asked.
  bool check_properties(const YAML::Mark& mark, const std::string& tag) {
    const char first = at(mark);
    const bool anchor = first == '&';
    const bool has_tag = first == '!' || (tag != "?" && tag != "!" && !tag.empty());
    if (anchor) refuse(to_mark(mark), "anchor ('&name'); remove it, aliases are not taken either");
    if (has_tag)
      refuse(to_mark(mark), "tag ('!...'); remove it, the schema says what type each key has");
    return !anchor && !has_tag;
  }

  void open(const YAML::Mark& mark, const std::string& tag, NodeKind kind) {
    check_properties(mark, tag);
    if (open_.size() >= static_cast<std::size_t>(kMaxDepth)) {
      refuse(to_mark(mark),
             "nested deeper than " + std::to_string(kMaxDepth) + " levels; no config needs that");
      throw Stop{};
    }
    open_.push_back(Open{.node = Node{.kind = kind, .mark = to_mark(mark)}});
  }
  void close() {
    Node node = std::move(open_.back().node);
    open_.pop_back();
    place(std::move(node));
  }

  /// A finished node goes where it belongs: the root, a list, or a map as key and value in turn.
  void place(Node node) {
    if (open_.empty()) {
      root = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == NodeKind::map && !parent.has_key) {
      take_key(parent, std::move(node));
      return;
    }
    parent.has_key = false;
    if (parent.drop_value) {
      parent.drop_value = false;
      return;
    }
    if (parent.node.kind == NodeKind::map) parent.node.keys.push_back(std::move(parent.key));
    parent.node.items.push_back(std::move(node));
  }
  void take_key(Open& map, Node node) {
    map.has_key = true;
    if (node.kind != NodeKind::scalar) {
      map.drop_value = true;
      if (node.kind != NodeKind::refused) refuse(node.mark, "a key must be a word");
      return;
    }
    const auto [before, is_new] = map.lines.emplace(node.text, node.mark.line);
    if (!is_new) {
      map.drop_value = true;
      refuse(node.mark, "duplicate key " + quote(node.text) + ": it was given before in line " +
                            std::to_string(before->second) + "; keep one of them");
      return;
    }
    map.key = YamlKey{std::move(node.text), node.mark};
  }

  const std::string& text_;
  const std::string& file_;
  int documents_ = 0;
  std::vector<Open> open_;
};

/// Runs the parser; what it throws becomes an error of the builder. Returns whether the syntax was
/// sound to the end.
bool run_parser(const std::string& text, TreeBuilder& builder) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (parser.HandleNextDocument(builder)) parser.HandleNextDocument(builder);
    return true;
  } catch (const Stop&) {
  } catch (const YAML::Exception& error) {
    builder.refuse(to_mark(error.mark), "YAML syntax: " + error.msg);
  }
  return false;
}

}  // namespace

const Node* find(const Node& map, const std::string& key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i].text == key) return &map.items[i];
  }
  return nullptr;
}

YamlText parse_yaml(const std::string& text, const std::string& file) {
  YamlText result;
  if (ConfigError problem = first_text_problem(text, file); !problem.message.empty()) {
    result.errors.push_back(std::move(problem));
    return result;
  }
  TreeBuilder builder(text, file);
  result.sound = run_parser(text, builder);
  if (builder.errors.empty() && !builder.any_document()) {
    builder.refuse({1, 1},
                   "the file is empty; expected keys with values, as a config has, which starts "
                   "with 'version: 1', or a coupling file with its 'blocks'");
    result.sound = false;
  }
  result.root = std::move(builder.root);
  result.errors = std::move(builder.errors);
  return result;
}

}  // namespace hapticd::config
