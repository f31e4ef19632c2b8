#include "experiments/configuration.h"

#include <cstddef>

#include "common/measurement/gauge.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

constexpr std::size_t kWidth = 100;

std::vector<std::string> SplitKey(const std::string& key) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = key.find('.', begin);
    names.push_back(key.substr(begin, dot - begin));
    if (dot == std::string::npos) return names;
    begin = dot + 1;
  }
}

/// A comment, broken at spaces.
void AppendComment(const std::string& text, const std::string& indent, std::string* out) {
  const std::string head = indent + "# ";
  std::string line = head;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.size() > head.size() && line.size() + 1 + word.size() > kWidth) {
      *out += line + "\n";
      line = head;
    }
    line += (line.size() > head.size() ? " " : "") + word;
  }
  *out += line + "\n";
}

}  // namespace

void Configuration::Read(ConfigSources* sources) {
  sources->Read("shared", &shared);
  sources->Read("initialization", &initialization);
  sources->Read("frontend", &frontend);
  sources->Read("msckf", &backends.msckf);
  sources->Read("window", &backends.window);
  sources->Read("evaluation", &evaluation);
  sources->CheckAllKeysUsed();
  const std::string gauge = GaugeError(shared.calibration);
  if (!gauge.empty()) throw InputError("shared.calibration.imu_frame: " + gauge);
}

std::string DocumentedYaml(const std::vector<ResolvedValue>& values) {
  std::string text;
  std::vector<std::string> open;  // the groups that the last key stood in
  for (const ResolvedValue& value : values) {
    const std::vector<std::string> names = SplitKey(value.key);
    std::size_t depth = 0;
    while (depth < open.size() && depth + 1 < names.size() && open[depth] == names[depth]) ++depth;
    open.resize(depth);
    for (; depth + 1 < names.size(); ++depth) {
      if (depth == 0 && !text.empty()) text += "\n";
      text += std::string(2 * depth, ' ') + names[depth] + ":\n";
      open.push_back(names[depth]);
    }
    const std::string indent(2 * depth, ' ');
    std::string meaning = value.doc + " (" + value.type;
    if (!value.unit.empty()) meaning += "; " + value.unit;
    AppendComment(meaning + ")", indent, &text);
    text += indent + names.back() + ": " + value.value + "\n";
  }
  return text;
}

}  // namespace duet
