#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace duet {

/// What a folder of results says about how it came to be (DESIGN.md section 4). Keys keep their
/// order, so that manifests can be compared by eye.
using Manifest = nlohmann::ordered_json;

/// Program, commit, build, libraries, machine, start time and command line.
[[nodiscard]] Manifest StartManifest(const std::string& command_line);

/// Writes manifest.json into the folder. Throws OutputError.
void WriteManifest(const Manifest& manifest, const std::filesystem::path& folder);

/// Most memory this process has held so far (VmHWM), 1e6 bytes; negative where it is not known.
[[nodiscard]] double PeakMemoryMb();

}  // namespace duet
