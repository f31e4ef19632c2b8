#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/yaml_node.h"

namespace duet {

/// Scalars of a type, strictly: nothing for text that is not entirely of it, and for numbers that
/// are not finite. A quoted text is only ever a text.
[[nodiscard]] std::optional<bool> AsBool(const YamlNode& node);
[[nodiscard]] std::optional<int> AsInteger(const YamlNode& node);
[[nodiscard]] std::optional<double> AsNumber(const YamlNode& node);
[[nodiscard]] std::optional<std::string> AsText(const YamlNode& node);
[[nodiscard]] std::optional<std::vector<int>> AsIntegers(const YamlNode& node);
[[nodiscard]] std::optional<std::vector<double>> AsNumbers(const YamlNode& node);

/// What a node is, for "..., got X".
[[nodiscard]] std::string Describe(const YamlNode& node);

struct NumberRange {
  double min = -1e300;
  double max = 1e300;
};
/// "a number", "a number of at least 0", "a number from 0 to 1".
[[nodiscard]] std::string DescribeRange(const std::string& what, const NumberRange& range);

/// The entries of a map, asked for by name; every wrong answer is an InputError that names file,
/// line, key and what was expected. For the files of sensors; options structs have
/// config_sources.h.
class YamlMap {
 public:
  /// `path` is the key of the map itself ("" at the top). The node must outlive the map.
  YamlMap(const YamlNode& node, std::string file, std::string path = "");

  [[nodiscard]] bool Has(const std::string& key);
  [[nodiscard]] double Number(const std::string& key, const NumberRange& range = {});
  [[nodiscard]] double NumberOr(const std::string& key, double value_if_missing,
                                const NumberRange& range = {});
  [[nodiscard]] int Integer(const std::string& key, const NumberRange& range = {});
  [[nodiscard]] std::string Text(const std::string& key);
  /// `count` numbers; any count where it is -1.
  [[nodiscard]] std::vector<double> Numbers(const std::string& key, int count = -1);
  [[nodiscard]] YamlMap Map(const std::string& key);
  /// Any kind of value.
  [[nodiscard]] const YamlNode& Node(const std::string& key);

  [[noreturn]] void Fail(const std::string& key, const std::string& text) const;

  /// Keys that nobody has asked for. One that is near to a name that was asked for and is missing
  /// is taken for a misspelling: InputError.
  [[nodiscard]] std::vector<std::string> UnknownKeys() const;

  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  [[nodiscard]] const YamlNode* Find(const std::string& key);
  [[nodiscard]] const YamlNode& Require(const std::string& key, const std::string& expected);
  [[noreturn]] void FailType(const std::string& key, const std::string& expected) const;
  [[nodiscard]] std::string FullKey(const std::string& key) const;

  const YamlNode* node_;
  std::string file_;
  std::string path_;
  std::vector<std::string> asked_;
};

}  // namespace duet
