#include <cstdio>
#include <filesystem>

#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/study/study_products.h"
#include "experiments/study/study_verify.h"
#include "experiments/study_pictures.h"

namespace duet {
namespace {

int RunVerify(const CommandLine& line) {
  if (line.operands().size() != 1) {
    throw InputError("duet verify needs the folder of one study; see duet help verify");
  }
  const std::filesystem::path folder = line.operands().front();
  // A search (duet tune) has no pictures.
  const bool has_pictures =
      std::filesystem::exists(folder / "report.html") || !ReadProducts(folder).empty();
  const StudyVerification found =
      VerifyStudy(folder, has_pictures ? StudyDerivation(PictureTexts) : nullptr);
  if (Interrupted()) return kInterrupted;
  for (const std::string& note : found.notes) std::printf("note: %s\n", note.c_str());
  for (const std::string& problem : found.problems) std::printf("wrong: %s\n", problem.c_str());
  std::printf("%d records and %d streams: %s\n", found.runs, found.streams,
              found.problems.empty() ? "every number is what they give"
                                     : (std::to_string(found.problems.size()) + " wrong").c_str());
  return found.problems.empty() ? kDone : kBoundNotMet;
}

}  // namespace

Command VerifyCommand() {
  return {.name = "verify",
          .summary = "Derives every number of a study's folder again from its records.",
          .description =
              "Makes the plan of study.yaml again, recomputes the ids and hashes of streams and "
              "records, evaluates the records anew and makes runs.csv, the tables, the figures' "
              "data and report.html again; says what is missing, what has changed and what is from "
              "another version of the program, with exit status 1. Streams are not simulated or "
              "tracked again, nor are the estimators run.",
          .example = "duet verify h2h",
          .operands = "DIR",
          .run = RunVerify};
}

}  // namespace duet
