#pragma once

#include "experiments/command_line.h"

namespace duet {

/// The subcommands, one file each.
[[nodiscard]] Command TrackCommand();
[[nodiscard]] Command RunCommand();
[[nodiscard]] Command CompareCommand();
[[nodiscard]] Command EvaluateCommand();
[[nodiscard]] Command ConfigCommand();
[[nodiscard]] Command SimulateCommand();
[[nodiscard]] Command CheckCommand();
[[nodiscard]] Command MonteCarloCommand();
[[nodiscard]] Command TrackErrorCommand();
[[nodiscard]] Command AllanCommand();
[[nodiscard]] Command AblateCommand();
[[nodiscard]] Command ObservabilityCommand();
[[nodiscard]] Command ReportCommand();
[[nodiscard]] Command StudyCommand();
[[nodiscard]] Command VerifyCommand();
[[nodiscard]] Command TuneCommand();
[[nodiscard]] Command FigureCommand();

}  // namespace duet
