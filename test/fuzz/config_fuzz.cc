#include "common/config/config_sources.h"
#include "common/measurement/calibration.h"
#include "common/measurement/standstill.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

namespace {

enum class Choice { kFirst, kSecond };

/// A field of every type.
struct Options {
  int integer = 3;
  std::string text = "a b";
  std::vector<int> integers = {1, 2};
  std::vector<double> numbers = {0.5};
  Choice choice = Choice::kFirst;
  duet::CalibrationPriors calibration;
  duet::StandstillOptions standstill;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("integer", &integer, {.doc = "doc", .min = -5, .max = 5});
    v.Field("text", &text, {.doc = "doc"});
    v.Field("integers", &integers, {.doc = "doc"});
    v.Field("numbers", &numbers, {.doc = "doc"});
    v.Choice("choice", &choice, {{"first", Choice::kFirst}, {"second", Choice::kSecond}},
             {.doc = "doc"});
    v.Group("calibration", &calibration, "doc");
    v.Group("standstill", &standstill, "doc");
  }
};

}  // namespace

/// A file, then overrides, one a line.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    duet::ConfigSources sources;
    sources.AddText(duet::TakeFirstPart(&text), "f");
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      sources.AddOverride(std::string(text.substr(0, end)));
      text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
    Options options;
    sources.Read("a", &options);
    sources.CheckAllKeysUsed();
    duet::ConfigSources again;
    again.AddText(sources.ResolvedYaml(), "g");
    Options same;
    again.Read("a", &same);
    CHECK_EQ(again.SettingsSha256(), sources.SettingsSha256());
  });
}
