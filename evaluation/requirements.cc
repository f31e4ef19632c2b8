#include "evaluation/requirements.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void Fail(const std::string& text) { throw InputError("", 0, "--require", text); }

std::string Trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Where `path` leads, or nullptr. A key may hold dots itself (a file's name), so that every key
/// that the path goes on with is tried.
const Json* Follow(const Json& json, std::string_view path) {
  if (json.is_array()) {
    const std::size_t dot = path.find('.');
    const auto index = ParseUint64(path.substr(0, dot));
    if (!index || *index >= json.size()) return nullptr;
    if (dot == std::string_view::npos) return &json[*index];
    return Follow(json[*index], path.substr(dot + 1));
  }
  if (!json.is_object()) return nullptr;
  for (const auto& [key, value] : json.items()) {
    if (path == key) return &value;
    if (path.size() > key.size() && path.starts_with(key) && path[key.size()] == '.') {
      if (const Json* found = Follow(value, path.substr(key.size() + 1))) return found;
    }
  }
  return nullptr;
}

void CollectPaths(const Json& json, const std::string& path, std::vector<std::string>* paths) {
  if (!json.is_structured()) {
    paths->push_back(path);
    return;
  }
  for (const auto& [key, value] : json.items()) {
    CollectPaths(value, path.empty() ? key : path + "." + key, paths);
  }
}

/// Whether the path goes through a list or through an object that is filled only by a run.
bool LeadsThroughOpenPart(const Json& json, std::string_view path) {
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos;
       dot = path.find('.', dot + 1)) {
    const Json* found = Follow(json, path.substr(0, dot));
    if (found == nullptr) continue;
    if (found->is_array() || (found->is_object() && found->empty())) return true;
  }
  return false;
}

std::string ValueText(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

bool Holds(const Json& value, const Requirement& requirement) {
  const auto bound = ParseDouble(requirement.bound);
  if (requirement.relation == Requirement::Relation::kEqual && !(value.is_number() && bound)) {
    return !value.is_null() && ValueText(value) == requirement.bound;
  }
  if (!value.is_number() || !bound) return false;
  const double x = value.get<double>();
  switch (requirement.relation) {
    case Requirement::Relation::kLess:
      return x < *bound;
    case Requirement::Relation::kLessOrEqual:
      return x <= *bound;
    case Requirement::Relation::kGreater:
      return x > *bound;
    case Requirement::Relation::kGreaterOrEqual:
      return x >= *bound;
    case Requirement::Relation::kEqual:
      return x == *bound;
  }
  return false;
}

}  // namespace

Requirement ParseRequirement(const std::string& text) {
  using Relation = Requirement::Relation;
  Requirement requirement;
  requirement.text = text;
  const std::size_t at = text.find_first_of("<>=");
  const std::string usage =
      "expected PATH<BOUND with <, <=, >, >= or ==, such as msckf.ate.position_m<0.01, got \"" +
      text + "\"";
  if (at == std::string::npos) Fail(usage);
  const bool or_equal = text.size() > at + 1 && text[at + 1] == '=';
  if (text[at] == '=' && !or_equal) Fail(usage);
  if (text[at] == '<') {
    requirement.relation = or_equal ? Relation::kLessOrEqual : Relation::kLess;
  } else if (text[at] == '>') {
    requirement.relation = or_equal ? Relation::kGreaterOrEqual : Relation::kGreater;
  } else {
    requirement.relation = Relation::kEqual;
  }
  requirement.path = Trimmed(text.substr(0, at));
  requirement.bound = Trimmed(text.substr(at + (or_equal ? 2 : 1)));
  const auto bound = ParseDouble(requirement.bound);
  const bool bound_fits = requirement.relation == Relation::kEqual
                              ? !requirement.bound.empty()
                              : bound.has_value() && *bound == *bound;
  if (requirement.path.empty() || !bound_fits) Fail(usage);
  return requirement;
}

void CheckRequirementPath(const Requirement& requirement, const Json& json, bool is_template) {
  if (is_template && LeadsThroughOpenPart(json, requirement.path)) return;
  const Json* value = Follow(json, requirement.path);
  if (value != nullptr && !value->is_structured()) return;
  std::vector<std::string> paths;
  CollectPaths(json, "", &paths);
  std::string hint = DidYouMean(requirement.path, paths);
  if (value != nullptr) {
    hint = "; it goes on with \"." + (value->empty() ? "0" : value->items().begin().key()) + "\"";
  }
  Fail("\"" + requirement.path + "\" is no result" + hint);
}

RequirementOutcome EvaluateRequirement(const Requirement& requirement, const Json& json) {
  CheckRequirementPath(requirement, json);
  const Json& value = *Follow(json, requirement.path);
  RequirementOutcome outcome;
  outcome.met = Holds(value, requirement);
  outcome.text = requirement.text + (outcome.met ? ": met, it is " : ": not met, it is ") +
                 (value.is_null() ? "not known" : ValueText(value));
  return outcome;
}

}  // namespace duet
