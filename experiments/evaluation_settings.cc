#include "experiments/evaluation_settings.h"

#include <algorithm>

#include "common/support/input_error.h"

namespace duet {

void RequireEvaluationDefaults(const std::vector<ResolvedValue>& values,
                               const std::vector<UnusedSetting>& unused) {
  for (const auto& [name, why] : unused) {
    const std::string key = "evaluation." + name;
    const auto found =
        std::find_if(values.begin(), values.end(),
                     [&key](const ResolvedValue& value) { return value.key == key; });
    if (found == values.end() || found->value == found->preset) continue;
    throw InputError(key + ": has no effect " + why + "; expected the default, " + found->preset);
  }
}

}  // namespace duet
