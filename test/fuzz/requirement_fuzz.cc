#include <nlohmann/json.hpp>

#include "common/support/logging.h"
#include "evaluation/comparison.h"
#include "evaluation/requirements.h"
#include "test/fuzz/fuzz_reader.h"

// Bounds on comparison.json: what is accepted before the runs is met by no number that is missing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const nlohmann::ordered_json paths = duet::ComparisonTemplate({"msckf", "window"});
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const duet::Requirement requirement = duet::ParseRequirement(std::string(text));
    const duet::RequirementOutcome outcome = duet::EvaluateRequirement(requirement, paths);
    CHECK(!outcome.text.empty());
    duet::CheckRequirementPath(requirement, paths, true);
  });
}
