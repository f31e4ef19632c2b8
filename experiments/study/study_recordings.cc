// recordings.json: which recordings a study's folder was made from.

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/study/study_plan.h"

namespace duet {
namespace {

constexpr std::uint64_t kMostFrames = std::numeric_limits<int>::max();

}  // namespace

void WriteRecordings(const StudyRecordings& recordings, const std::filesystem::path& folder) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [key, recording] : recordings) {
    json[key] = {{"path", recording.path.string()},
                 {"fingerprint_sha256", recording.fingerprint},
                 {"has_images", recording.has_images},
                 {"frames", recording.frames}};
  }
  ReplaceTextFile(
      folder / "recordings.json",
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

StudyRecordings ReadRecordings(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "recordings.json";
  if (!std::filesystem::exists(file)) return {};
  return ParseRecordings(ReadTextFile(file), file.string());
}

StudyRecordings ParseRecordings(std::string_view text, const std::string& file) {
  StudyRecordings recordings;
  try {
    const auto json = nlohmann::ordered_json::parse(text);
    if (!json.is_object()) throw InputError(file, 0, "", "is no list of recordings");
    for (const auto& [key, value] : json.items()) {
      const auto& frames = value.at("frames");
      if (!frames.is_number_unsigned() || frames.get<std::uint64_t>() > kMostFrames) {
        throw InputError(file, 0, key + ".frames", "expected a number of frames");
      }
      recordings[key] = {.path = value.at("path").get<std::string>(),
                         .fingerprint = value.at("fingerprint_sha256").get<std::string>(),
                         .has_images = value.at("has_images").get<bool>(),
                         .frames = frames.get<int>()};
    }
  } catch (const nlohmann::ordered_json::exception& error) {
    throw InputError(file, 0, "", std::string("is no list of recordings: ") + error.what());
  }
  return recordings;
}

}  // namespace duet
