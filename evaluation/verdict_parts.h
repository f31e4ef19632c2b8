#pragma once

#include <string>
#include <vector>

#include "evaluation/study_comparison.h"

namespace duet {

/// What the sentences of verdicts share.

/// One of the two is called better.
[[nodiscard]] bool IsDecided(Decision decision);

/// "1 pair", "2 pairs".
[[nodiscard]] std::string CountText(int count, const char* noun);

/// How sure: " (95 % interval 0.79 to 0.90; 60 pairs on 3 streams, p < 0.001 after Holm's
/// correction)". Where pairs with one failed run are in the test, it says that p is of them too.
[[nodiscard]] std::string EvidenceText(const MetricComparison& comparison,
                                       const ArmComparison& arms, const Band& interval,
                                       int decimals);

/// On how many streams alone the same is shown, on how many the contrary, and on how many no data
/// could show it; empty with one stream.
[[nodiscard]] std::string StreamsText(const ArmComparison& arms, Decision decision);

/// DESIGN.md section 5.2: a general verdict takes at least three streams.
[[nodiscard]] std::string FewStreamsText(const ArmComparison& arms);

/// Why a comparison with Decision::kTooFew can show nothing, and how many pairs could.
[[nodiscard]] std::string TooFewText(const MetricComparison& comparison,
                                     const PairedComparison& paired);

/// What so many pairs can show in so many tests, so that "nothing" is read as it is meant: "; so
/// many pairs show a difference of 8.1 % four times in five".
[[nodiscard]] std::string DetectableText(const MetricComparison& comparison,
                                         const PairedComparison& paired);

/// Each clause as a sentence on a line of its own: a capital where the program's words begin, a
/// full stop.
[[nodiscard]] std::string SentencesOf(const std::vector<std::string>& clauses);

}  // namespace duet
