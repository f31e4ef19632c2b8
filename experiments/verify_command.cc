#include <cstdio>

#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/study/study_verify.h"

namespace duet {
namespace {

int RunVerify(const CommandLine& line) {
  if (line.operands().size() != 1) {
    throw InputError("duet verify needs the folder of one study; see duet help verify");
  }
  const StudyVerification found = VerifyStudy(line.operands().front());
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
              "Recomputes the ids and hashes of a study's streams and records, evaluates the "
              "records anew and makes runs.csv and the tables again; says what is missing, what "
              "has changed and what is from another version of the program, with exit status 1.",
          .example = "duet verify h2h",
          .operands = "DIR",
          .run = RunVerify};
}

}  // namespace duet
