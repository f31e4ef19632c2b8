#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/options.h"
#include "common/config/yaml_node.h"

namespace duet {

/// One setting in force.
struct ResolvedValue {
  std::string key;     ///< "msckf.window"
  std::string type;    ///< "integer from 2 to 100", "one of dense, sparse", ...
  std::string unit;    ///< may be empty
  std::string doc;     ///< a sentence
  std::string value;   ///< as YAML
  std::string preset;  ///< the default, as YAML; empty where there is none
  std::string origin;  ///< "default", "FILE:LINE" or "command line"
};

/// Where settings come from (DESIGN.md section 4): defaults < files in order < overrides in order.
///
///   ConfigSources sources;
///   sources.AddFile("configs/estimators/default.yaml");
///   sources.AddOverride("msckf.window=15");
///   sources.Read("shared", &shared_options);
///   sources.Read("msckf", &msckf_options);
///   sources.CheckAllKeysUsed();
///   WriteTextFile("config.yaml", sources.ResolvedYaml());
///
/// Every error is an InputError that names file, line and key (or the override), what was expected
/// and, for a misspelling, the nearest key.
class ConfigSources {
 public:
  void AddFile(const std::filesystem::path& path);
  /// As AddFile with the file's text; `file` is named in errors and origins.
  void AddText(std::string_view yaml, const std::string& file);
  /// "key.sub=value", the value in YAML ("true", "[1, 2]"); from the command line.
  void AddOverride(const std::string& assignment);
  /// One key of a file that is no configuration itself ("msckf.window" below a study's `set`); it
  /// rules as the file's text would.
  void AddKey(const std::string& key, const YamlNode& value, const std::string& file);

  /// Fills the struct from the sources; its fields' keys stand below `section` ("shared",
  /// "study.world"). A section is read once.
  template <class Options>
  void Read(const std::string& section, Options* options);

  /// Refuses keys that no struct has read. Call it after the last Read.
  void CheckAllKeysUsed() const;

  /// All settings read so far, in the order of reading.
  [[nodiscard]] const std::vector<ResolvedValue>& values() const { return values_; }

  /// A configuration file that gives these settings again, each with its origin as a comment.
  [[nodiscard]] std::string ResolvedYaml() const;
  /// SHA-256 over the settings in force (keys and values, sorted by key; not the origins).
  [[nodiscard]] std::string SettingsSha256() const;
  /// What a key, or every key of a section, means: type, unit, range, default, value in force.
  /// Throws InputError for a key that no struct has. "" explains everything.
  [[nodiscard]] std::string Explain(const std::string& key) const;

 private:
  class Reader;

  struct Source {
    YamlNode root;
    std::string file;
    bool is_override = false;
  };
  struct Group {
    std::string doc;
    std::vector<std::string> children;  ///< names, in the order of reading
  };

  void AddSource(Source source);
  void StartSection(const std::string& section);
  void AddChild(const std::string& group, const std::string& name);
  [[nodiscard]] const YamlNode* FindIn(const Source& source, const std::string& key) const;
  void CheckNode(const Source& source, const YamlNode& node, const std::string& group) const;
  [[noreturn]] void FailUnknown(const Source& source, int line, const std::string& group,
                                const std::string& name) const;
  [[nodiscard]] const ResolvedValue* FindValue(const std::string& key) const;
  void AppendYaml(const std::string& group, int depth, std::string* text) const;

  std::vector<Source> sources_;
  std::vector<ResolvedValue> values_;
  std::map<std::string, Group> groups_{{"", {}}};  ///< by path; "" is the top
};

/// Reads fields from the sources; made by ConfigSources::Read only.
class ConfigSources::Reader : public OptionVisitor {
 public:
  Reader(ConfigSources* sources, const std::string& section);

 private:
  void VisitField(const std::string& name, const FieldPointer& value,
                  const FieldInfo& info) override;
  void VisitChoice(const std::string& name, std::size_t* index,
                   const std::vector<std::string>& names, const FieldInfo& info) override;
  void EnterGroup(const std::string& name, const std::string& doc) override;
  void LeaveGroup() override;

  [[nodiscard]] std::string KeyOf(const std::string& name) const;
  /// Calls assign(node) for the key's node of every source, in order of precedence; assign says
  /// whether the node is what `resolved.type` promises. Sets the origin.
  template <class Assign>
  void ReadFromSources(ResolvedValue* resolved, bool required, const Assign& assign);

  ConfigSources* sources_;
  std::string path_;
  std::vector<std::string> outer_paths_;
};

template <class Options>
void ConfigSources::Read(const std::string& section, Options* options) {
  Reader reader(this, section);
  options->Visit(static_cast<OptionVisitor&>(reader));
}

}  // namespace duet
