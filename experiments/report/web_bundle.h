#pragma once

#include <string_view>

namespace duet {

/// The interactive part of a report, from web/ (web/build.sh makes web/dist/): in the program
/// itself, which needs no files beside it.
struct WebBundle {
  std::string_view script;
  std::string_view style;
  std::string_view licences;  ///< of the libraries that are in the script
};
[[nodiscard]] WebBundle GetWebBundle();

}  // namespace duet
