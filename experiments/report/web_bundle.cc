#include "experiments/report/web_bundle.h"

// The assembler copies the files into read-only data; DUET_WEB_DIST is their folder, and the build
// knows that this object depends on them (CMakeLists.txt).
#define DUET_EMBED(symbol, file)          \
  asm(".pushsection .rodata\n"            \
      ".global duet_web_" symbol          \
      "_begin\n"                          \
      ".global duet_web_" symbol          \
      "_end\n"                            \
      "duet_web_" symbol                  \
      "_begin:\n"                         \
      ".incbin \"" DUET_WEB_DIST "/" file \
      "\"\n"                              \
      "duet_web_" symbol                  \
      "_end:\n"                           \
      ".byte 0\n"                         \
      ".popsection\n")

DUET_EMBED("script", "report.js");
DUET_EMBED("style", "report.css");
DUET_EMBED("licences", "LICENSES.txt");

extern "C" {
extern const char duet_web_script_begin[], duet_web_script_end[];
extern const char duet_web_style_begin[], duet_web_style_end[];
extern const char duet_web_licences_begin[], duet_web_licences_end[];
}

namespace duet {
namespace {

std::string_view Between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

WebBundle GetWebBundle() {
  return {.script = Between(duet_web_script_begin, duet_web_script_end),
          .style = Between(duet_web_style_begin, duet_web_style_end),
          .licences = Between(duet_web_licences_begin, duet_web_licences_end)};
}

}  // namespace duet
