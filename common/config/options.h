#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace duet {

/// How an options struct describes itself: each field is named ONCE, in its struct's Visit, and
/// that one line drives reading, dumping, command-line overrides, range checks and `config
/// --explain`:
///
///   template <class Visitor> void Visit(Visitor& v) {
///     v.Field("max_tracks", &max_tracks,
///             {.doc = "Most tracks in a frame.", .min = 10, .max = 2000});
///     v.Field("pixel_noise_px", &pixel_noise_px, {.doc = "...", .unit = "px", .min = 1e-3});
///     v.Group("calibration", &calibration, "...");   // a nested struct with its own Visit
///     v.Choice("solver", &solver, {{"dense", Solver::kDense}, ...}, {.doc = "..."});  // an enum
///   }
///
/// Defaults are the members' initializers. The machinery behind it is
/// common/config/config_sources.h; this header is cheap to include.
struct FieldInfo {
  std::string doc = {};
  std::string unit = {};
  double min = -1e300;
  double max = 1e300;
  /// No default: a configuration that does not name it is refused.
  bool required = false;
};

/// What Field takes.
using FieldPointer =
    std::variant<bool*, int*, double*, std::string*, std::vector<int>*, std::vector<double>*>;

/// Walks the fields of an options struct; what it does with them is up to the derived class.
class OptionVisitor {
 public:
  OptionVisitor() = default;
  OptionVisitor(const OptionVisitor&) = delete;
  OptionVisitor& operator=(const OptionVisitor&) = delete;
  virtual ~OptionVisitor() = default;

  void Field(const char* name, const FieldPointer& value, const FieldInfo& info) {
    VisitField(name, value, info);
  }

  template <class Enum>
  void Choice(const char* name, Enum* value,
              std::initializer_list<std::pair<const char*, Enum>> choices, const FieldInfo& info) {
    std::vector<std::string> names;
    std::size_t index = choices.size();
    for (const auto& [text, choice] : choices) {
      if (choice == *value) index = names.size();
      names.emplace_back(text);
    }
    VisitChoice(name, &index, names, info);
    *value = (choices.begin() + index)->second;
  }

  template <class Options>
  void Group(const char* name, Options* options, const std::string& doc) {
    EnterGroup(name, doc);
    options->Visit(*this);
    LeaveGroup();
  }

 private:
  virtual void VisitField(const std::string& name, const FieldPointer& value,
                          const FieldInfo& info) = 0;
  /// `index` counts in `names`; names.size() where the default is none of them.
  virtual void VisitChoice(const std::string& name, std::size_t* index,
                           const std::vector<std::string>& names, const FieldInfo& info) = 0;
  virtual void EnterGroup(const std::string& name, const std::string& doc) = 0;
  virtual void LeaveGroup() = 0;
};

}  // namespace duet
