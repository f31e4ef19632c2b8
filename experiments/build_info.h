#pragma once

#include <string>
#include <utility>
#include <vector>

namespace duet {

/// What this program was built from and with, for manifests and `duet version`.
struct BuildInfo {
  std::string version;
  std::string commit;  ///< of git, with "-dirty" where the tree differed; "unknown" without git
  std::string build_type;
  std::string flags;
  std::string compiler;
  std::vector<std::pair<std::string, std::string>> libraries;  ///< name, version
};

[[nodiscard]] const BuildInfo& GetBuildInfo();

/// Files of the linear algebra that this process has loaded (BLAS, LAPACK, CHOLMOD, SPQR), links
/// resolved: which BLAS is in use is decided by the machine, not by the build.
[[nodiscard]] std::vector<std::string> LoadedLinearAlgebra();

/// The text of `duet version`.
[[nodiscard]] std::string BuildDescription();

/// "Intel(R) ... , 2 cores, Linux 6.1".
[[nodiscard]] std::string MachineDescription();

}  // namespace duet
