#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace duet {

/// A bound on a result: `--require 'msckf.ate.position_m<0.01'`.
struct Requirement {
  enum class Relation { kLess, kLessOrEqual, kGreater, kGreaterOrEqual, kEqual };
  std::string text;  ///< as it was given
  std::string path;  ///< keys joined by dots; an index for a list: "msckf.relative.0.segments"
  Relation relation = Relation::kLess;
  std::string bound;  ///< a number; for == any text, compared as a number where both are
};

/// PATH < BOUND with <, <=, >, >= or ==; blanks around the parts are ignored. Throws InputError
/// (key "--require").
[[nodiscard]] Requirement ParseRequirement(const std::string& text);

/// Throws InputError where the path leads to no number, text or truth value of `json`; it names the
/// nearest one that there is. Where `json` is a template, lists and empty objects are not followed:
/// what they hold is not known before the run.
void CheckRequirementPath(const Requirement& requirement, const nlohmann::ordered_json& json,
                          bool is_template = false);

struct RequirementOutcome {
  bool met = false;
  std::string text;  ///< "msckf.ate.position_m<0.01: not met, it is 0.0123"
};

/// A value that does not exist (null: an estimator that failed) meets nothing.
[[nodiscard]] RequirementOutcome EvaluateRequirement(const Requirement& requirement,
                                                     const nlohmann::ordered_json& json);

}  // namespace duet
