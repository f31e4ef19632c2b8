#include "common/config/yaml_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

template <class Value, class Convert>
std::optional<std::vector<Value>> AsList(const YamlNode& node, Convert convert) {
  if (node.kind != YamlNode::Kind::kSequence) return std::nullopt;
  std::vector<Value> values;
  values.reserve(node.items.size());
  for (const YamlNode& item : node.items) {
    const std::optional<Value> value = convert(item);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::optional<bool> AsBool(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) return std::nullopt;
  if (node.scalar == "true") return true;
  if (node.scalar == "false") return false;
  return std::nullopt;
}

std::optional<int> AsInteger(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) return std::nullopt;
  const std::optional<std::int64_t> value = ParseInt64(node.scalar);
  if (!value || *value < std::numeric_limits<int>::min() ||
      *value > std::numeric_limits<int>::max()) {
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<double> AsNumber(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) return std::nullopt;
  const std::optional<double> value = ParseDouble(node.scalar);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::string> AsText(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kScalar) return std::nullopt;
  return node.scalar;
}

std::optional<std::vector<int>> AsIntegers(const YamlNode& node) {
  return AsList<int>(node, AsInteger);
}

std::optional<std::vector<double>> AsNumbers(const YamlNode& node) {
  return AsList<double>(node, AsNumber);
}

std::string Describe(const YamlNode& node) {
  constexpr std::size_t kLongest = 60;
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kScalar:
      return "'" + node.scalar.substr(0, kLongest) + (node.scalar.size() > kLongest ? "...'" : "'");
    case YamlNode::Kind::kSequence:
      return "a list of " + std::to_string(node.items.size());
    case YamlNode::Kind::kMap:
      return "a map";
  }
  return "nothing";
}

std::string DescribeRange(const std::string& what, const NumberRange& range) {
  constexpr double kUnbounded = 1e300;
  const bool has_min = range.min > -kUnbounded;
  const bool has_max = range.max < kUnbounded;
  if (has_min && has_max) {
    return what + " from " + FormatNumber(range.min) + " to " + FormatNumber(range.max);
  }
  if (has_min) return what + " of at least " + FormatNumber(range.min);
  if (has_max) return what + " of at most " + FormatNumber(range.max);
  return what;
}

YamlMap::YamlMap(const YamlNode& node, std::string file, std::string path)
    : node_(&node), file_(std::move(file)), path_(std::move(path)) {
  if (node.kind != YamlNode::Kind::kMap) {
    throw InputError(file_, node.line, path_,
                     "expected keys with values, got " + duet::Describe(node));
  }
}

std::string YamlMap::FullKey(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

void YamlMap::Fail(const std::string& key, const std::string& text) const {
  const YamlNode* node = node_->Find(key);
  throw InputError(file_, node == nullptr ? node_->line : node->line, FullKey(key), text);
}

void YamlMap::FailType(const std::string& key, const std::string& expected) const {
  Fail(key, "expected " + expected + ", got " + Describe(*node_->Find(key)));
}

const YamlNode* YamlMap::Find(const std::string& key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.push_back(key);
  return node_->Find(key);
}

bool YamlMap::Has(const std::string& key) { return Find(key) != nullptr; }

const YamlNode& YamlMap::Require(const std::string& key, const std::string& expected) {
  const YamlNode* node = Find(key);
  if (node != nullptr) return *node;
  std::vector<std::string> others;
  for (const YamlNode::Entry& entry : node_->entries) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) == asked_.end()) {
      others.push_back(entry.key);
    }
  }
  const std::string nearest = NearestName(key, others);
  Fail(key, "is missing; expected " + expected +
                (nearest.empty() ? "" : "; is '" + nearest + "' meant to be it?"));
}

double YamlMap::Number(const std::string& key, const NumberRange& range) {
  const std::string expected = DescribeRange("a number", range);
  const std::optional<double> value = AsNumber(Require(key, expected));
  if (!value || *value < range.min || *value > range.max) FailType(key, expected);
  return *value;
}

double YamlMap::NumberOr(const std::string& key, double value_if_missing,
                         const NumberRange& range) {
  return Has(key) ? Number(key, range) : value_if_missing;
}

int YamlMap::Integer(const std::string& key, const NumberRange& range) {
  const std::string expected = DescribeRange("an integer", range);
  const std::optional<int> value = AsInteger(Require(key, expected));
  if (!value || *value < range.min || *value > range.max) FailType(key, expected);
  return *value;
}

std::string YamlMap::Text(const std::string& key) {
  const std::optional<std::string> value = AsText(Require(key, "a text"));
  if (!value) FailType(key, "a text");
  return *value;
}

std::vector<double> YamlMap::Numbers(const std::string& key, int count) {
  const std::string expected =
      count < 0 ? "a list of numbers" : "a list of " + std::to_string(count) + " numbers";
  std::optional<std::vector<double>> values = AsNumbers(Require(key, expected));
  if (!values || (count >= 0 && static_cast<int>(values->size()) != count)) {
    FailType(key, expected);
  }
  return *std::move(values);
}

YamlMap YamlMap::Map(const std::string& key) {
  return YamlMap(Require(key, "keys with values"), file_, FullKey(key));
}

const YamlNode& YamlMap::Node(const std::string& key) { return Require(key, "a value"); }

std::vector<std::string> YamlMap::UnknownKeys() const {
  std::vector<std::string> missing;
  for (const std::string& key : asked_) {
    if (node_->Find(key) == nullptr) missing.push_back(key);
  }
  std::vector<std::string> unknown;
  for (const YamlNode::Entry& entry : node_->entries) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
    const std::string nearest = NearestName(entry.key, missing);
    if (!nearest.empty()) {
      throw InputError(file_, entry.line, FullKey(entry.key),
                       "unknown key; did you mean '" + nearest + "'?");
    }
    unknown.push_back(FullKey(entry.key));
  }
  return unknown;
}

}  // namespace duet
