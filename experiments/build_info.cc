#include "experiments/build_info.h"

#include <ceres/version.h>
#include <link.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <climits>
#include <cstdlib>
#include <fstream>
#include <opencv2/core/version.hpp>

#include "duet_build.h"
#include "duet_commit.h"

namespace duet {
namespace {

std::string EigenVersion() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

int CollectLibrary(dl_phdr_info* info, std::size_t /*size*/, void* data) {
  const std::string path = info->dlpi_name == nullptr ? "" : info->dlpi_name;
  const std::string name = path.substr(path.rfind('/') + 1);
  for (const char* part : {"blas", "lapack", "mkl", "cholmod", "spqr"}) {
    if (name.find(part) == std::string::npos) continue;
    char resolved[PATH_MAX];
    static_cast<std::vector<std::string>*>(data)->push_back(
        realpath(path.c_str(), resolved) == nullptr ? path : resolved);
    break;
  }
  return 0;
}

}  // namespace

const BuildInfo& GetBuildInfo() {
  static const BuildInfo info = {
      .version = DUET_BUILD_VERSION,
      .commit = DUET_BUILD_COMMIT,
      .build_type = DUET_BUILD_TYPE,
      .flags = DUET_BUILD_FLAGS,
      .compiler = DUET_BUILD_COMPILER,
      .libraries = {{"Ceres", CERES_VERSION_STRING},
                    {"Eigen", EigenVersion()},
                    {"OpenCV", CV_VERSION},
                    {"gflags", DUET_BUILD_GFLAGS},
                    {"glog", DUET_BUILD_GLOG},
                    {"yaml-cpp", DUET_BUILD_YAML_CPP},
                    {"OpenSSL", DUET_BUILD_OPENSSL}},
  };
  return info;
}

std::vector<std::string> LoadedLinearAlgebra() {
  std::vector<std::string> paths;
  dl_iterate_phdr(CollectLibrary, &paths);
  std::sort(paths.begin(), paths.end());
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  return paths;
}

std::string BuildDescription() {
  const BuildInfo& info = GetBuildInfo();
  std::string text = "duet " + info.version + " (commit " + info.commit + ")\n" + "build     " +
                     info.build_type + ", " + info.compiler + "\n" + "flags     " + info.flags +
                     "\n" + "libraries";
  for (const auto& [name, version] : info.libraries) text += " " + name + " " + version + ",";
  text.back() = '\n';
  for (const std::string& path : LoadedLinearAlgebra()) text += "loaded    " + path + "\n";
  return text;
}

std::string MachineDescription() {
  std::string model = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      model = line.substr(colon + 2);
      break;
    }
  }
  utsname system{};
  std::string kernel;
  if (uname(&system) == 0) kernel = std::string(", ") + system.sysname + " " + system.release;
  return model + ", " + std::to_string(sysconf(_SC_NPROCESSORS_ONLN)) + " cores" + kernel;
}

}  // namespace duet
