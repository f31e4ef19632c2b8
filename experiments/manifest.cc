#include "experiments/manifest.h"

#include <ctime>
#include <fstream>
#include <sstream>

#include "common/support/text_file.h"
#include "experiments/build_info.h"

namespace duet {
namespace {

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

Manifest StartManifest(const std::string& command_line) {
  const BuildInfo& build = GetBuildInfo();
  Manifest manifest;
  manifest["program"] = "duet";
  manifest["version"] = build.version;
  manifest["commit"] = build.commit;
  manifest["build"] = {
      {"type", build.build_type}, {"flags", build.flags}, {"compiler", build.compiler}};
  for (const auto& [name, version] : build.libraries) manifest["libraries"][name] = version;
  manifest["linear_algebra"] = LoadedLinearAlgebra();
  manifest["machine"] = MachineDescription();
  manifest["started"] = UtcNow();
  manifest["command_line"] = command_line;
  return manifest;
}

void WriteManifest(const Manifest& manifest, const std::filesystem::path& folder) {
  // A path or an argument may hold bytes that are no UTF-8; they are replaced, not refused.
  WriteTextFile(folder / "manifest.json",
                manifest.dump(2, ' ', false, Manifest::error_handler_t::replace) + "\n");
}

double PeakMemoryMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) != 0) continue;
    double kilobytes = -1.0;
    std::istringstream(line.substr(6)) >> kilobytes;
    return kilobytes * 1024e-6;
  }
  return -1.0;
}

}  // namespace duet
