#include "experiments/study/study_tables.h"

#include <filesystem>
#include <memory>

#include "evaluation/published.h"

namespace duet {

StudyTableOptions TableOptionsOf(const StudyFolder& folder) {
  const StudyFile& study = folder.study;
  StudyTableOptions options;
  if (!study.metrics.empty()) options.metrics = study.metrics;
  options.compare = ComparedAxisFromName(StudyCompareName(study.compare));
  // Estimators are compared each with each.
  if (study.compare != StudyCompare::kEstimators) options.baseline = study.baseline;
  for (const StudyStream& stream : study.streams) {
    if (stream.jitter_px > 0.0) options.chaos_streams.push_back(stream.name);
  }
  if (std::filesystem::exists(folder.path / "published")) {
    options.published = std::make_shared<const Published>(ReadPublished(folder.path / "published"));
  }
  return options;
}

std::vector<std::pair<std::string, std::string>> TableTexts(const std::vector<StudyTable>& tables) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const StudyTable& table : tables) {
    const std::string base = "tables/" + table.name;
    texts.emplace_back(base + ".txt", TableText(table));
    texts.emplace_back(base + ".csv", TableCsv(table));
    texts.emplace_back(base + ".md", TableMarkdown(table));
    texts.emplace_back(base + ".tex", TableLatex(table));
  }
  return texts;
}

}  // namespace duet
