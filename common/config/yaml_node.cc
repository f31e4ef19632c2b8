#include "common/config/yaml_node.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <sstream>
#include <utility>

#include "common/support/input_error.h"

namespace duet {
namespace {

/// Builds the tree from yaml-cpp's events: its own Node silently accepts repeated keys.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Refuse(mark, "", anchor);
    Add(MakeNode(YamlNode::Kind::kNull, mark));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw InputError(file_, mark.line + 1, "", "aliases are not accepted; write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Refuse(mark, tag, anchor);
    YamlNode node = MakeNode(YamlNode::Kind::kScalar, mark);
    node.scalar = value;
    node.quoted = tag == "!";
    Add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Refuse(mark, tag, anchor);
    open_.push_back({MakeNode(YamlNode::Kind::kSequence, mark), {}, 0, false});
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Refuse(mark, tag, anchor);
    open_.push_back({MakeNode(YamlNode::Kind::kMap, mark), {}, 0, false});
  }
  void OnMapEnd() override { Close(); }

  [[nodiscard]] YamlNode TakeRoot() { return std::move(root_); }

 private:
  struct Open {
    YamlNode node;
    std::string key;
    int key_line;
    bool has_key;
  };

  static YamlNode MakeNode(YamlNode::Kind kind, const YAML::Mark& mark) {
    YamlNode node;
    node.kind = kind;
    node.line = mark.line + 1;
    return node;
  }

  void Refuse(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (anchor != 0) {
      throw InputError(file_, mark.line + 1, "", "anchors are not accepted; write the value out");
    }
    const bool is_opencv_matrix =
        tag == "tag:yaml.org,2002:opencv-matrix" || tag == "!opencv-matrix";
    if (!tag.empty() && tag != "?" && tag != "!" && !is_opencv_matrix) {
      throw InputError(file_, mark.line + 1, "", "the tag '" + tag + "' is not accepted");
    }
  }

  void Close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    Add(std::move(node));
  }

  void Add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::kSequence) {
      parent.node.items.push_back(std::move(node));
    } else if (parent.has_key) {
      // yaml-cpp puts a missing value where the next token stands.
      if (node.kind == YamlNode::Kind::kNull) node.line = parent.key_line;
      parent.node.entries.push_back({std::move(parent.key), parent.key_line, std::move(node)});
      parent.has_key = false;
    } else {
      StartEntry(&parent, std::move(node));
    }
  }

  void StartEntry(Open* parent, YamlNode key) const {
    if (key.kind != YamlNode::Kind::kScalar) {
      throw InputError(file_, key.line, "", "a key has to be a word");
    }
    for (const YamlNode::Entry& entry : parent->node.entries) {
      if (entry.key == key.scalar) {
        throw InputError(file_, key.line, key.scalar,
                         "repeated key; it stands in line " + std::to_string(entry.line) + " too");
      }
    }
    parent->key = std::move(key.scalar);
    parent->key_line = key.line;
    parent->has_key = true;
  }

  std::string file_;
  std::vector<Open> open_;
  YamlNode root_;
};

}  // namespace

const YamlNode* YamlNode::Find(std::string_view key) const {
  for (const Entry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

YamlNode ParseYaml(std::string_view text, const std::string& file) {
  // No configuration or calibration comes near; what does is another file, given by mistake.
  constexpr std::size_t kMostBytes = 1 << 20;
  if (text.size() > kMostBytes) {
    throw InputError(file, 0, "", "is no configuration: longer than a megabyte");
  }
  if (text.find('\0') != std::string_view::npos) {
    throw InputError(file, 0, "", "is no text: it contains a zero byte");
  }
  std::string document(text);
  // A comment in its place keeps the line numbers.
  if (document.starts_with("%YAML:")) document[0] = '#';
  try {
    std::istringstream stream(document);
    YAML::Parser parser(stream);
    TreeBuilder builder(file);
    if (!parser.HandleNextDocument(builder)) return YamlNode();
    YamlNode root = builder.TakeRoot();
    TreeBuilder second(file);
    if (parser.HandleNextDocument(second)) {
      throw InputError(file, second.TakeRoot().line, "", "a second document; expected one only");
    }
    return root;
  } catch (const YAML::Exception& error) {
    throw InputError(file, error.mark.line + 1, "", "is no YAML: " + error.msg);
  }
}

std::string QuotedYaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') {
      // A line's end would be read as a blank.
      constexpr const char* kDigits = "0123456789abcdef";
      quoted += std::string("\\x") + kDigits[c >> 4] + kDigits[c & 15];
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace duet
