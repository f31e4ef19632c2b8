#include "common/config/config_sources.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "common/config/yaml_map.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

std::string Join(const std::string& group, const std::string& name) {
  return group.empty() ? name : group + "." + name;
}

/// "a.b.c" as "a.b" and "c".
std::pair<std::string, std::string> SplitLast(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return {"", key};
  return {key.substr(0, dot), key.substr(dot + 1)};
}

std::vector<std::string> SplitKey(const std::string& key) {
  std::vector<std::string> names;
  std::size_t start = 0;
  while (true) {
    const std::size_t dot = key.find('.', start);
    names.push_back(key.substr(start, dot - start));
    if (dot == std::string::npos) return names;
    start = dot + 1;
  }
}

/// Maps within maps, by the names of a key, that end in `node`; nothing where a name is empty.
std::optional<YamlNode> Nested(const std::string& key, YamlNode node) {
  const std::vector<std::string> names = SplitKey(key);
  for (auto name = names.rbegin(); name != names.rend(); ++name) {
    if (name->empty()) return std::nullopt;
    YamlNode parent;
    parent.kind = YamlNode::Kind::kMap;
    parent.line = node.line;
    parent.entries.push_back({*name, node.line, std::move(node)});
    node = std::move(parent);
  }
  return node;
}

/// Assigns a node to a field where it is of the field's type and range.
struct FieldAssigner {
  const YamlNode& node;
  NumberRange range;

  bool operator()(bool* value) const { return Store(AsBool(node), value); }
  bool operator()(int* value) const { return Store(AsInteger(node), value); }
  bool operator()(double* value) const { return Store(AsNumber(node), value); }
  bool operator()(std::string* value) const { return Store(AsText(node), value); }
  bool operator()(std::vector<int>* value) const { return Store(AsIntegers(node), value); }
  bool operator()(std::vector<double>* value) const { return Store(AsNumbers(node), value); }

  bool InRange(bool) const { return true; }
  bool InRange(const std::string&) const { return true; }
  bool InRange(int value) const { return value >= range.min && value <= range.max; }
  bool InRange(double value) const { return value >= range.min && value <= range.max; }
  template <class Number>
  bool InRange(const std::vector<Number>& values) const {
    return std::all_of(values.begin(), values.end(), [this](Number v) { return InRange(v); });
  }

  template <class Value>
  bool Store(std::optional<Value> read, Value* value) const {
    if (!read || !InRange(*read)) return false;
    *value = *std::move(read);
    return true;
  }
};

/// The type in words, for errors and explanations.
struct TypeWriter {
  NumberRange range;

  std::string operator()(const bool*) const { return "true or false"; }
  std::string operator()(const int*) const { return DescribeRange("an integer", range); }
  std::string operator()(const double*) const { return DescribeRange("a number", range); }
  std::string operator()(const std::string*) const { return "a text"; }
  std::string operator()(const std::vector<int>*) const {
    return DescribeRange("a list of integers, each", range);
  }
  std::string operator()(const std::vector<double>*) const {
    return DescribeRange("a list of numbers, each", range);
  }
};

std::string QuoteText(const std::string& text) {
  const bool is_word = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '/' || c == '.';
  });
  const bool is_special = ParseDouble(text) || text == "true" || text == "false" ||
                          text == "null" || text == "Null" || text == "NULL";
  if (is_word && !is_special) return text;
  std::string quoted = "\"";
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += {'\\', 'x', kHexDigits[static_cast<unsigned char>(c) >> 4], kHexDigits[c & 15]};
    } else {
      quoted.push_back(c);
    }
  }
  return quoted + "\"";
}

/// A field's value as YAML that reads back to the same.
struct ValueWriter {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const double* value) const { return FormatNumber(*value); }
  std::string operator()(const std::string* value) const { return QuoteText(*value); }
  template <class Number>
  std::string operator()(const std::vector<Number>* values) const {
    std::string text = "[";
    for (const Number value : *values) {
      if (text.size() > 1) text += ", ";
      AppendNumber(value, &text);
    }
    return text + "]";
  }
};

}  // namespace

void ConfigSources::AddFile(const std::filesystem::path& path) {
  AddText(ReadTextFile(path), path.string());
}

void ConfigSources::AddText(std::string_view yaml, const std::string& file) {
  Source source{ParseYaml(yaml, file), file, false};
  if (source.root.kind != YamlNode::Kind::kMap && source.root.kind != YamlNode::Kind::kNull) {
    throw InputError(file, source.root.line, "",
                     "expected keys with values, got " + Describe(source.root));
  }
  AddSource(std::move(source));
}

void ConfigSources::AddSource(Source source) {
  // Files rule over files before them, and overrides over every file.
  const auto first_override = std::find_if(sources_.begin(), sources_.end(),
                                           [](const Source& other) { return other.is_override; });
  sources_.insert(first_override, std::move(source));
}

void ConfigSources::AddOverride(const std::string& assignment) {
  const std::string shown = "--set " + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw InputError(shown, 0, "", "expected KEY=VALUE");
  const std::string key = assignment.substr(0, equals);
  std::optional<YamlNode> node =
      Nested(key, ParseYaml(std::string_view(assignment).substr(equals + 1), shown));
  if (!node) throw InputError(shown, 0, "", "expected KEY=VALUE, got an empty key");
  sources_.push_back({*std::move(node), shown, true});
}

void ConfigSources::AddKey(const std::string& key, const YamlNode& value, const std::string& file) {
  std::optional<YamlNode> node = Nested(key, value);
  if (!node) throw InputError(file, value.line, key, "expected names joined by dots");
  AddSource({*std::move(node), file, false});
}

void ConfigSources::AddChild(const std::string& group, const std::string& name) {
  std::vector<std::string>& children = groups_[group].children;
  if (std::find(children.begin(), children.end(), name) == children.end()) {
    children.push_back(name);
  }
}

void ConfigSources::StartSection(const std::string& section) {
  std::string path;
  for (const std::string& name : SplitKey(section)) {
    AddChild(path, name);
    path = Join(path, name);
    groups_.try_emplace(path);
  }
}

const YamlNode* ConfigSources::FindIn(const Source& source, const std::string& key) const {
  const YamlNode* node = &source.root;
  std::string path;
  for (const std::string& name : SplitKey(key)) {
    if (node->kind == YamlNode::Kind::kNull) return nullptr;  // a section without keys
    if (node->kind != YamlNode::Kind::kMap) {
      throw InputError(source.file, node->line, path,
                       "expected keys with values, got " + Describe(*node));
    }
    node = node->Find(name);
    if (node == nullptr) return nullptr;
    path = Join(path, name);
  }
  return node;
}

void ConfigSources::CheckAllKeysUsed() const {
  for (const Source& source : sources_) CheckNode(source, source.root, "");
}

void ConfigSources::CheckNode(const Source& source, const YamlNode& node,
                              const std::string& group) const {
  const std::vector<std::string>& known = groups_.at(group).children;
  for (const YamlNode::Entry& entry : node.entries) {
    if (std::find(known.begin(), known.end(), entry.key) == known.end()) {
      FailUnknown(source, entry.line, group, entry.key);
    }
    const std::string path = Join(group, entry.key);
    if (groups_.contains(path)) {
      const YamlNode::Kind kind = entry.value.kind;
      if (kind != YamlNode::Kind::kMap && kind != YamlNode::Kind::kNull) {
        throw InputError(source.file, entry.line, path,
                         "expected keys with values, got " + Describe(entry.value));
      }
      CheckNode(source, entry.value, path);
    }
  }
}

void ConfigSources::FailUnknown(const Source& source, int line, const std::string& group,
                                const std::string& name) const {
  std::string hint = DidYouMean(name, groups_.at(group).children);
  // The right name in the wrong section.
  for (const ResolvedValue& value : values_) {
    if (hint.empty() && SplitLast(value.key).second == name) {
      hint = "; did you mean '" + value.key + "'?";
    }
  }
  throw InputError(source.file, source.is_override ? 0 : line, Join(group, name),
                   "unknown key" + hint);
}

const ResolvedValue* ConfigSources::FindValue(const std::string& key) const {
  for (const ResolvedValue& value : values_) {
    if (value.key == key) return &value;
  }
  return nullptr;
}

void ConfigSources::AppendYaml(const std::string& group, int depth, std::string* text) const {
  const auto found = groups_.find(group);
  if (found == groups_.end()) return;
  for (const std::string& name : found->second.children) {
    const std::string path = Join(group, name);
    text->append(2 * static_cast<std::size_t>(depth), ' ');
    if (groups_.contains(path)) {
      *text += name + ":\n";
      AppendYaml(path, depth + 1, text);
      continue;
    }
    const ResolvedValue& value = *CHECK_NOTNULL(FindValue(path));
    *text += name + ": " + value.value + "  # " + value.origin;
    *text += (value.unit.empty() ? "" : " [" + value.unit + "]") + "\n";
  }
}

std::string ConfigSources::ResolvedYaml() const {
  std::string text = "# Every setting in force, and where it came from.\n";
  AppendYaml("", 0, &text);
  return text;
}

std::string ConfigSources::SettingsSha256() const {
  std::vector<std::string> lines;
  for (const ResolvedValue& value : values_) lines.push_back(value.key + "=" + value.value + "\n");
  std::sort(lines.begin(), lines.end());
  Sha256 sha256;
  for (const std::string& line : lines) sha256.Update(line);
  return sha256.Finish();
}

std::string ConfigSources::Explain(const std::string& key) const {
  std::string text;
  const auto group = groups_.find(key);
  if (!key.empty() && group != groups_.end() && !group->second.doc.empty()) {
    text += key + ": " + group->second.doc + "\n";
  }
  for (const ResolvedValue& value : values_) {
    if (!key.empty() && value.key != key && !value.key.starts_with(key + ".")) continue;
    text += value.key + ": " + value.doc + "\n    " + value.type;
    if (!value.unit.empty()) text += " [" + value.unit + "]";
    text += value.preset.empty() ? ", no default" : ", default " + value.preset;
    if (value.origin != "default") text += ", in force " + value.value + " (" + value.origin + ")";
    text += "\n";
  }
  if (!text.empty() || group != groups_.end()) return text;
  std::vector<std::string> known;
  for (const ResolvedValue& value : values_) known.push_back(value.key);
  for (const auto& [path, unused] : groups_) known.push_back(path);
  std::string hint = DidYouMean(key, known);
  for (const ResolvedValue& value : values_) {
    if (hint.empty() && SplitLast(value.key).second == key) {
      hint = "; did you mean '" + value.key + "'?";
    }
  }
  throw InputError("", 0, key, "unknown key" + hint);
}

ConfigSources::Reader::Reader(ConfigSources* sources, const std::string& section)
    : sources_(sources), path_(section) {
  sources_->StartSection(section);
}

std::string ConfigSources::Reader::KeyOf(const std::string& name) const {
  return Join(path_, name);
}

template <class Assign>
void ConfigSources::Reader::ReadFromSources(ResolvedValue* resolved, bool required,
                                            const Assign& assign) {
  CHECK(sources_->FindValue(resolved->key) == nullptr) << resolved->key << " is named twice";
  bool found = false;
  for (const Source& source : sources_->sources_) {
    const YamlNode* node = sources_->FindIn(source, resolved->key);
    if (node == nullptr) continue;
    const int line = source.is_override ? 0 : node->line;
    if (!assign(*node)) {
      const std::string unit = resolved->unit.empty() ? "" : " [" + resolved->unit + "]";
      throw InputError(source.file, line, resolved->key,
                       "expected " + resolved->type + unit + ", got " + Describe(*node));
    }
    found = true;
    resolved->origin =
        source.is_override ? "command line" : source.file + ":" + std::to_string(line);
  }
  if (!found && required) {
    std::string files;
    for (const Source& source : sources_->sources_) {
      if (!source.is_override) files += (files.empty() ? "" : ", ") + source.file;
    }
    throw InputError(files, 0, resolved->key,
                     "is missing and has no default; expected " + resolved->type);
  }
  sources_->AddChild(SplitLast(resolved->key).first, SplitLast(resolved->key).second);
}

void ConfigSources::Reader::VisitField(const std::string& name, const FieldPointer& value,
                                       const FieldInfo& info) {
  const NumberRange range{info.min, info.max};
  ResolvedValue resolved;
  resolved.key = KeyOf(name);
  resolved.type = std::visit(TypeWriter{range}, value);
  resolved.unit = info.unit;
  resolved.doc = info.doc;
  resolved.origin = "default";
  if (!info.required) {
    resolved.preset = std::visit(ValueWriter(), value);
    const YamlNode preset = ParseYaml(resolved.preset, resolved.key);
    CHECK(std::visit(FieldAssigner{preset, range}, value))
        << "the default of " << resolved.key << " (" << resolved.preset << ") is no "
        << resolved.type;
  }
  ReadFromSources(&resolved, info.required, [&](const YamlNode& node) {
    return std::visit(FieldAssigner{node, range}, value);
  });
  resolved.value = std::visit(ValueWriter(), value);
  sources_->values_.push_back(std::move(resolved));
}

void ConfigSources::Reader::VisitChoice(const std::string& name, std::size_t* index,
                                        const std::vector<std::string>& names,
                                        const FieldInfo& info) {
  CHECK_LT(*index, names.size()) << "the default of " << KeyOf(name) << " has no name";
  ResolvedValue resolved;
  resolved.key = KeyOf(name);
  for (const std::string& choice : names) {
    resolved.type += (resolved.type.empty() ? "one of " : ", ") + choice;
  }
  resolved.unit = info.unit;
  resolved.doc = info.doc;
  resolved.origin = "default";
  if (!info.required) resolved.preset = QuoteText(names[*index]);
  ReadFromSources(&resolved, info.required, [&](const YamlNode& node) {
    const auto found = std::find(names.begin(), names.end(), AsText(node).value_or(""));
    if (found == names.end()) return false;
    *index = static_cast<std::size_t>(found - names.begin());
    return true;
  });
  resolved.value = QuoteText(names[*index]);
  sources_->values_.push_back(std::move(resolved));
}

void ConfigSources::Reader::EnterGroup(const std::string& name, const std::string& doc) {
  outer_paths_.push_back(path_);
  sources_->AddChild(path_, name);
  path_ = KeyOf(name);
  sources_->groups_[path_].doc = doc;
}

void ConfigSources::Reader::LeaveGroup() {
  path_ = outer_paths_.back();
  outer_paths_.pop_back();
}

}  // namespace duet
