#include <cstdio>
#include <exception>

#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/log_capture.h"

namespace duet {
namespace {

int Fail(ExitStatus status, const char* what) {
  std::fprintf(stderr, "duet: %s\n", what);
  return status;
}

int Run(int argc, char** argv) {
  try {
    return Dispatch(
        {CompareCommand(), TrackCommand(), RunCommand(), EvaluateCommand(), CheckCommand(),
         ObservabilityCommand(), AblateCommand(), StudyCommand(), VerifyCommand(), TuneCommand(),
         FigureCommand(), ReportCommand(), SimulateCommand(), MonteCarloCommand(),
         TrackErrorCommand(), AllanCommand(), ConfigCommand()},
        argc, argv);
  } catch (const InputError& error) {
    return Fail(kBadInput, error.what());
  } catch (const OutputError& error) {
    return Fail(kWritingFailed, error.what());
  } catch (const std::exception& error) {
    return Fail(kInternalError, (std::string("internal error: ") + error.what()).c_str());
  }
}

}  // namespace
}  // namespace duet

int main(int argc, char** argv) {
  // Into a file too, a table's lines and what is said on stderr keep their order, and none is torn.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  duet::InitializeLogging(argv[0]);
  duet::InstallInterruptHandler();
  return duet::Run(argc, argv);
}
