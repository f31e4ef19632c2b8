// StudyYaml: a study as text again.

#include <algorithm>
#include <cctype>
#include <string_view>

#include "common/support/numeric_text.h"
#include "experiments/study/study_file.h"

namespace duet {
namespace {

/// True for what needs no quotes within a list; numbers, true and false are.
bool IsPlain(const std::string& scalar) {
  return std::all_of(scalar.begin(), scalar.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_.+-/").find(c) != std::string_view::npos;
  });
}

std::string KeyYaml(const std::string& key) {
  return IsPlain(key) && !key.empty() ? key : QuotedYaml(key);
}

/// A value in one line.
std::string FlowYaml(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "~";
    case YamlNode::Kind::kScalar:
      return node.quoted || !IsPlain(node.scalar) ? QuotedYaml(node.scalar) : node.scalar;
    case YamlNode::Kind::kSequence:
    case YamlNode::Kind::kMap:
      break;
  }
  std::string text;
  for (const YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + FlowYaml(item);
  for (const YamlNode::Entry& entry : node.entries) {
    text += (text.empty() ? "" : ", ") + KeyYaml(entry.key) + ": " + FlowYaml(entry.value);
  }
  return node.kind == YamlNode::Kind::kMap ? "{" + text + "}" : "[" + text + "]";
}

std::string SetYaml(const std::vector<StudyKey>& set, const std::string& indent,
                    const std::string& name = "set") {
  if (set.empty()) return "";
  std::string text = indent + name + ":\n";
  for (const StudyKey& key : set) {
    text += indent + "  " + KeyYaml(key.key) + ": " + FlowYaml(key.value) + "\n";
  }
  return text;
}

template <class Number>
std::string ListYaml(const std::vector<Number>& values) {
  std::string text;
  for (const Number value : values) {
    if (!text.empty()) text += ", ";
    AppendNumber(value, &text);
  }
  return "[" + text + "]";
}

std::string TextsYaml(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + QuotedYaml(text);
  return "[" + list + "]";
}

std::string StreamYaml(const StudyStream& stream) {
  std::string text = "  - name: " + QuotedYaml(stream.name) + "\n";
  if (stream.simulated()) {
    text += "    simulate: " + QuotedYaml(stream.simulate) + "\n";
    if (stream.simulation_seed) {
      text += "    simulation_seed: " + std::to_string(*stream.simulation_seed) + "\n";
    }
  } else {
    text += "    dataset: " + QuotedYaml(stream.dataset) + "\n";
    text += "    cameras: " + ListYaml(stream.cameras) + "\n";
    text += "    starts_s: " + ListYaml(stream.starts_s) + "\n";
    text += "    duration_s: " + FormatNumber(stream.duration_s) + "\n";
  }
  text += "    jitter_px: " + FormatNumber(stream.jitter_px) + "\n";
  text += "    init: " + stream.init + "\n";
  return text + SetYaml(stream.set, "    ");
}

std::string ChangesYaml(const std::vector<StudyChange>& changes) {
  std::string text;
  for (const StudyChange& change : changes) {
    text += "  - name: " + QuotedYaml(change.name) + "\n" + SetYaml(change.set, "    ");
    if (!change.only.empty()) text += "    only:\n";
    for (const auto& [estimator, keys] : change.only) text += SetYaml(keys, "      ", estimator);
  }
  return text;
}

}  // namespace

std::string StreamsYaml(const std::vector<StudyStream>& streams) {
  std::string text;
  for (const StudyStream& stream : streams) text += StreamYaml(stream);
  return text;
}

std::string StudyYaml(const StudyFile& study) {
  std::string text = "study: " + QuotedYaml(study.name) + "\n";
  text += "question: " + QuotedYaml(study.question) + "\n";
  text += "streams:\n" + StreamsYaml(study.streams);
  text += "estimators: " + TextsYaml(study.estimators) + "\n";
  text += SetYaml(study.set, "");
  text += "settings:\n" + ChangesYaml(study.settings);
  text += "perturbations:\n" + ChangesYaml(study.perturbations);
  text += "seeds: " + std::to_string(study.seeds.first) + ".." + std::to_string(study.seeds.last) +
          "\n";
  text += "baseline: " + QuotedYaml(study.baseline) + "\n";
  text += std::string("compare: ") + StudyCompareName(study.compare) + "\n";
  if (!study.metrics.empty()) text += "metrics: " + TextsYaml(study.metrics) + "\n";
  if (study.figures) text += "figures: " + TextsYaml(*study.figures) + "\n";
  text += std::string("measure_time: ") + (study.measure_time ? "true" : "false") + "\n";
  if (study.skip_missing) text += "skip_missing: true\n";
  if (!study.published.empty()) text += "published: " + QuotedYaml(study.published) + "\n";
  return text;
}

}  // namespace duet
