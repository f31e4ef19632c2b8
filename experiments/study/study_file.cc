#include "experiments/study/study_file.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "backends/factory.h"
#include "common/config/yaml_map.h"
#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/text_file.h"
#include "evaluation/metrics.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRuns = 1'000'000;
constexpr double kLongest_s = 1e6;

/// Maps of a study's file: a key that is not known is an error, whatever it is like.
class StrictMap {
 public:
  StrictMap(const YamlNode& node, const std::string& file, const std::string& path,
            std::vector<std::string> known)
      : node_(node), file_(file), path_(path), map_(node, file, path), known_(std::move(known)) {
    for (const YamlNode::Entry& entry : node.entries) {
      if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
      throw InputError(file_, entry.line, KeyOf(entry.key),
                       "unknown key" + DidYouMean(entry.key, known_));
    }
  }

  [[nodiscard]] const YamlNode* Find(const std::string& key) const { return node_.Find(key); }
  [[nodiscard]] std::string KeyOf(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }
  [[noreturn]] void Fail(const std::string& key, const std::string& text) const {
    map_.Fail(key, text);
  }

  std::string Text(const std::string& key) { return map_.Text(key); }
  std::string TextOr(const std::string& key, const std::string& otherwise) {
    return Find(key) == nullptr ? otherwise : map_.Text(key);
  }
  double NumberOr(const std::string& key, double otherwise, const NumberRange& range) {
    return map_.NumberOr(key, otherwise, range);
  }
  int Integer(const std::string& key, const NumberRange& range) { return map_.Integer(key, range); }
  bool BoolOr(const std::string& key, bool otherwise) {
    const YamlNode* node = Find(key);
    if (node == nullptr) return otherwise;
    const std::optional<bool> value = AsBool(*node);
    if (!value) Fail(key, "expected true or false, got " + Describe(*node));
    return *value;
  }
  /// A list of texts; of `allowed` ones where that is not empty; none twice.
  std::vector<std::string> Texts(const std::string& key, const std::vector<std::string>& allowed) {
    std::vector<std::string> texts;
    for (const YamlNode& item : List(key, "a list of texts")) {
      const std::optional<std::string> text = AsText(item);
      if (!text || text->empty()) Fail(key, "expected a list of texts, got " + Describe(item));
      if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *text) == allowed.end()) {
        Fail(key, "'" + *text + "' is unknown" + DidYouMean(*text, allowed));
      }
      if (std::find(texts.begin(), texts.end(), *text) != texts.end()) {
        Fail(key, "'" + *text + "' stands there twice");
      }
      texts.push_back(*text);
    }
    return texts;
  }
  const std::vector<YamlNode>& List(const std::string& key, const std::string& expected) {
    const YamlNode& node = map_.Node(key);
    if (node.kind != YamlNode::Kind::kSequence) {
      Fail(key, "expected " + expected + ", got " + Describe(node));
    }
    if (node.items.empty()) Fail(key, "is empty: nothing would be run; expected " + expected);
    return node.items;
  }

 private:
  const YamlNode& node_;
  std::string file_;
  std::string path_;
  YamlMap map_;
  std::vector<std::string> known_;
};

/// Names stand in tables and on command lines.
std::string CheckedName(StrictMap* map, const std::string& key) {
  std::string name = map->Text(key);
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view(" _-+.=/()<>%").find(c) != std::string_view::npos;
  };
  if (name.empty() || name.size() > 60 || !std::all_of(name.begin(), name.end(), fits) ||
      name.front() == ' ' || name.back() == ' ') {
    map->Fail(key, "expected a name of at most 60 letters, digits, blanks and _-+.=/()<>%, got '" +
                       name + "'");
  }
  return name;
}

/// Maps may be nested or have keys with dots; the leaves by their whole keys.
void AppendKeys(const YamlNode& node, const std::string& prefix, const std::string& file,
                std::vector<StudyKey>* keys) {
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string key = prefix.empty() ? entry.key : prefix + "." + entry.key;
    if (entry.value.kind == YamlNode::Kind::kMap) {
      AppendKeys(entry.value, key, file, keys);
    } else if (entry.value.kind != YamlNode::Kind::kNull) {
      // What comes later rules.
      std::erase_if(*keys, [&](const StudyKey& earlier) { return earlier.key == key; });
      keys->push_back({key, entry.value, file});
    }
  }
}

std::vector<StudyKey> ReadSet(const StrictMap& map, const std::string& file,
                              const std::vector<std::string>& sections,
                              const std::string& name = "set") {
  std::vector<StudyKey> keys;
  const YamlNode* node = map.Find(name);
  if (node == nullptr) return keys;
  if (node->kind != YamlNode::Kind::kMap) {
    map.Fail(name, "expected keys with values, got " + Describe(*node));
  }
  AppendKeys(*node, "", file, &keys);
  for (const StudyKey& key : keys) {
    const std::string section = key.key.substr(0, key.key.find('.'));
    if (std::find(sections.begin(), sections.end(), section) != sections.end()) continue;
    std::string expected;
    for (const std::string& each : sections) expected += (expected.empty() ? "" : ", ") + each;
    throw InputError(file, key.value.line, map.KeyOf(name) + "." + key.key,
                     "has no place here; expected keys of " + expected);
  }
  return keys;
}

/// What differs between runs on one stream; the front end's settings belong to a stream.
const std::vector<std::string>& RunSections() {
  static const std::vector<std::string> sections = [] {
    std::vector<std::string> all = {"shared", "initialization", "evaluation"};
    all.insert(all.end(), EstimatorNames().begin(), EstimatorNames().end());
    return all;
  }();
  return sections;
}

StudyStream ReadStream(const YamlNode& node, const std::string& file, const std::string& path) {
  StrictMap map(node, file, path,
                {"name", "simulate", "dataset", "set", "cameras", "starts_s", "duration_s",
                 "jitter_px", "simulation_seed", "init"});
  StudyStream stream;
  stream.line = node.line;
  stream.name = CheckedName(&map, "name");
  stream.simulate = map.TextOr("simulate", "");
  stream.dataset = map.TextOr("dataset", "");
  if (stream.simulate.empty() == stream.dataset.empty()) {
    throw InputError(file, node.line, path, "expected one of simulate (a preset) and dataset");
  }
  for (const char* key : {"cameras", "starts_s", "duration_s"}) {
    if (stream.simulated() && map.Find(key) != nullptr) {
      map.Fail(key, "is of a data set; a simulation has simulation.* below set");
    }
  }
  stream.set = ReadSet(map, file, {stream.simulated() ? "simulation" : "frontend"});
  for (const StudyKey& key : stream.set) {
    if (key.key != "simulation.seed") continue;
    throw InputError(file, key.value.line, key.key,
                     "is the run's; expected simulation_seed for one recording for all of them");
  }
  if (const YamlNode* cameras = map.Find("cameras")) {
    stream.cameras = AsIntegers(*cameras).value_or(std::vector<int>());
    const std::vector<std::vector<int>> choices = {{0}, {1}, {0, 1}};
    if (std::find(choices.begin(), choices.end(), stream.cameras) == choices.end()) {
      map.Fail("cameras", "expected [0], [1] or [0, 1]");
    }
  }
  if (const YamlNode* starts = map.Find("starts_s")) {
    stream.starts_s = AsNumbers(*starts).value_or(std::vector<double>());
    const bool fit = std::all_of(stream.starts_s.begin(), stream.starts_s.end(),
                                 [](double s) { return s >= 0.0 && s < kLongest_s; });
    if (stream.starts_s.empty() || !fit) {
      map.Fail("starts_s", "expected a list of times of at least 0 s");
    }
    if (std::set<double>(stream.starts_s.begin(), stream.starts_s.end()).size() !=
        stream.starts_s.size()) {
      map.Fail("starts_s", "holds a start twice: two runs would be the same");
    }
  }
  stream.duration_s = map.NumberOr("duration_s", 0.0, {0.0, kLongest_s});
  stream.jitter_px = map.NumberOr("jitter_px", 0.0, {0.0, 10.0});
  if (map.Find("simulation_seed") != nullptr) {
    if (!stream.simulated()) map.Fail("simulation_seed", "a data set has no seed");
    stream.simulation_seed = map.Integer("simulation_seed", {0, 2e9});
  }
  // The seed moves the pixels alone, in one world.
  if (stream.simulated() && stream.jitter_px > 0.0 && !stream.simulation_seed) {
    stream.simulation_seed = 1;
  }
  stream.init = map.TextOr("init", stream.simulated() ? "drawn" : "groundtruth");
  const std::vector<std::string> inits = {"groundtruth", "drawn", "rest", "auto"};
  if (std::find(inits.begin(), inits.end(), stream.init) == inits.end()) {
    map.Fail("init", "expected groundtruth, drawn, rest or auto" + DidYouMean(stream.init, inits));
  }
  return stream;
}

StudyChange ReadChange(const YamlNode& node, const std::string& file, const std::string& path) {
  StrictMap map(node, file, path, {"name", "set", "only"});
  StudyChange change{.name = CheckedName(&map, "name"), .set = ReadSet(map, file, RunSections())};
  if (const YamlNode* only = map.Find("only")) {
    const StrictMap estimators(*only, file, map.KeyOf("only"), EstimatorNames());
    for (const std::string& estimator : EstimatorNames()) {
      std::vector<StudyKey> keys = ReadSet(estimators, file, RunSections(), estimator);
      if (!keys.empty()) change.only[estimator] = std::move(keys);
    }
  }
  return change;
}

template <class Item, class Read>
std::vector<Item> ReadItems(StrictMap* map, const std::string& key, const std::string& file,
                            const Read& read) {
  std::vector<Item> items;
  for (const YamlNode& node : map->List(key, "a list of maps, each with a name")) {
    items.push_back(read(node, file, map->KeyOf(key) + "[" + std::to_string(items.size()) + "]"));
    for (std::size_t i = 0; i + 1 < items.size(); ++i) {
      if (items[i].name != items.back().name) continue;
      throw InputError(file, node.line, map->KeyOf(key),
                       "two are called '" + items.back().name + "'");
    }
  }
  return items;
}

void ReadConfigFiles(StrictMap* map, const fs::path& folder, StudyFile* study) {
  if (map->Find("config") == nullptr) return;
  for (const std::string& name : map->Texts("config", {})) {
    const fs::path path = (folder / name).lexically_normal();
    std::error_code error;  // no name of a file may be as long as a file's text
    if (!fs::exists(path, error)) map->Fail("config", path.string() + " does not exist");
    AppendKeys(ParseYaml(ReadTextFile(path), path.string()), "", path.string(), &study->set);
  }
}

std::vector<std::string> NamesOf(const std::vector<StudyChange>& changes) {
  std::vector<std::string> names;
  for (const StudyChange& change : changes) names.push_back(change.name);
  return names;
}

void ReadComparison(StrictMap* map, StudyFile* study) {
  const std::string compare = map->TextOr("compare", "estimators");
  const std::vector<std::string> choices = {"estimators", "settings", "perturbations"};
  const auto found = std::find(choices.begin(), choices.end(), compare);
  if (found == choices.end()) {
    map->Fail("compare", "expected estimators, settings or perturbations, got '" + compare + "'" +
                             DidYouMean(compare, choices));
  }
  study->compare = static_cast<StudyCompare>(found - choices.begin());
  const bool perturbations = study->compare == StudyCompare::kPerturbations;
  std::vector<std::string> names = NamesOf(perturbations ? study->perturbations : study->settings);
  study->baseline = map->TextOr("baseline", names.front());
  if (!perturbations) {
    const std::vector<std::string> others = NamesOf(study->perturbations);
    if (study->compare == StudyCompare::kEstimators) {
      names.insert(names.end(), others.begin(), others.end());
    }
  }
  if (std::find(names.begin(), names.end(), study->baseline) == names.end()) {
    map->Fail("baseline",
              "'" + study->baseline + "' is the name of none" + DidYouMean(study->baseline, names));
  }
}

/// The file's map with the keys of `quick` in the place of its own.
YamlNode WithQuick(const YamlNode& root, const std::string& file) {
  YamlNode merged = root;
  const YamlNode* quick = root.Find("quick");
  if (quick == nullptr) {
    throw InputError(file, 0, "quick", "is missing; --quick expects what it is to change");
  }
  if (quick->kind != YamlNode::Kind::kMap) {
    throw InputError(file, quick->line, "quick", "expected keys with values");
  }
  for (const YamlNode::Entry& entry : quick->entries) {
    if (entry.key == "study" || entry.key == "quick") {
      throw InputError(file, entry.line, "quick." + entry.key, "can't be changed by --quick");
    }
    const auto same = std::find_if(merged.entries.begin(), merged.entries.end(),
                                   [&](const YamlNode::Entry& e) { return e.key == entry.key; });
    if (same == merged.entries.end()) {
      merged.entries.push_back(entry);
    } else {
      same->value = entry.value;
    }
  }
  return merged;
}

}  // namespace

const char* StudyCompareName(StudyCompare compare) {
  switch (compare) {
    case StudyCompare::kEstimators:
      return "estimators";
    case StudyCompare::kSettings:
      return "settings";
    case StudyCompare::kPerturbations:
      return "perturbations";
  }
  return "";
}

StudyFile ParseStudyFile(std::string_view yaml, const fs::path& path, bool quick) {
  return StudyOfYaml(ParseYaml(yaml, path.string()), path, quick);
}

StudyFile StudyOfYaml(YamlNode root, const fs::path& path, bool quick) {
  StudyFile study;
  study.file = path.string();
  if (quick && root.kind == YamlNode::Kind::kMap) root = WithQuick(root, study.file);
  // What stands below quick is held to the same rules, also where it is not asked for.
  if (!quick && root.Find("quick") != nullptr) (void)StudyOfYaml(root, path, true);
  StrictMap map(root, study.file, "",
                {"study", "question", "streams", "estimators", "config", "set", "settings",
                 "perturbations", "seeds", "baseline", "compare", "metrics", "figures",
                 "measure_time", "skip_missing", "published", "quick"});
  study.name = CheckedName(&map, "study");
  study.question = map.TextOr("question", "");
  study.streams = ReadItems<StudyStream>(&map, "streams", study.file, ReadStream);
  study.estimators = map.Find("estimators") == nullptr ? EstimatorNames()
                                                       : map.Texts("estimators", EstimatorNames());
  ReadConfigFiles(&map, path.parent_path(), &study);
  std::vector<std::string> sections = RunSections();
  sections.emplace_back("frontend");
  for (StudyKey& key : ReadSet(map, study.file, sections)) {
    std::erase_if(study.set, [&](const StudyKey& earlier) { return earlier.key == key.key; });
    study.set.push_back(std::move(key));
  }
  study.settings = {{"default", {}}};
  if (map.Find("settings") != nullptr) {
    study.settings = ReadItems<StudyChange>(&map, "settings", study.file, ReadChange);
  }
  study.perturbations = {{"none", {}}};
  if (map.Find("perturbations") != nullptr) {
    study.perturbations = ReadItems<StudyChange>(&map, "perturbations", study.file, ReadChange);
  }
  if (const YamlNode* seeds = map.Find("seeds")) {
    study.seeds =
        ParseSeeds(AsText(*seeds).value_or(Describe(*seeds)), study.file, seeds->line, "seeds");
  }
  ReadComparison(&map, &study);
  if (map.Find("metrics") != nullptr) study.metrics = map.Texts("metrics", {});
  for (const std::string& metric : study.metrics) {
    if (FindMetric(metric)) continue;
    map.Fail("metrics", "no metric is called '" + metric + "'" + DidYouMean(metric, MetricKeys()));
  }
  if (const YamlNode* figures = map.Find("figures")) {
    const bool none = figures->kind == YamlNode::Kind::kSequence && figures->items.empty();
    study.figures = none ? std::vector<std::string>() : map.Texts("figures", {});
  }
  study.measure_time = map.BoolOr("measure_time", false);
  study.skip_missing = map.BoolOr("skip_missing", false);
  if (map.Find("published") != nullptr) {
    study.published = (path.parent_path() / map.Text("published")).lexically_normal().string();
    std::error_code error;
    if (!fs::is_directory(study.published, error)) {
      map.Fail("published", study.published + " is no folder");
    }
  }
  const std::size_t runs = study.streams.size() * study.estimators.size() * study.settings.size() *
                           study.perturbations.size() *
                           static_cast<std::size_t>(study.seeds.last - study.seeds.first + 1);
  if (runs > kMostRuns) {
    throw InputError(study.file, 0, "",
                     "asks for " + std::to_string(runs) + " runs; expected at most " +
                         std::to_string(kMostRuns));
  }
  return study;
}

StudyFile ReadStudyFile(const fs::path& file, bool quick) {
  return ParseStudyFile(ReadTextFile(file), file, quick);
}

}  // namespace duet
