#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace duet {

/// A node of a YAML document, with its line. Scalars stay text: what they are is decided by who
/// asks (common/config/yaml_map.h).
struct YamlNode {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  int line = 0;                 ///< from 1
  std::string scalar;           ///< of kScalar
  bool quoted = false;          ///< of kScalar
  std::vector<YamlNode> items;  ///< of kSequence
  std::vector<Entry> entries;   ///< of kMap, in the document's order; keys are unique

  /// The value of a key, or null.
  [[nodiscard]] const YamlNode* Find(std::string_view key) const;
};

struct YamlNode::Entry {
  std::string key;
  int line = 0;
  YamlNode value;
};

/// The text as a double-quoted YAML scalar.
[[nodiscard]] std::string QuotedYaml(const std::string& text);

/// Reads one YAML document; `file` is named in errors. Throws InputError for anything that is not
/// well formed and, beyond YAML, for repeated keys, keys that are no scalars, anchors and aliases,
/// tags and several documents. EuRoC's first line `%YAML:1.0` (OpenCV's, no YAML) and OpenCV's
/// matrix tag are accepted. An empty document gives a kNull node.
[[nodiscard]] YamlNode ParseYaml(std::string_view text, const std::string& file);

}  // namespace duet
