#pragma once

#include <filesystem>
#include <string>

namespace duet {

/// Runs the distribution's gnuplot over a script in `folder`, which it runs in. False where it is
/// not installed (the script is there to be run elsewhere). Throws OutputError where it fails; its
/// own words are on stderr.
[[nodiscard]] bool RunGnuplot(const std::filesystem::path& folder, const std::string& script);

}  // namespace duet
