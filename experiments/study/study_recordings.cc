// recordings.json: which recordings a study's folder was made from.

#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/study/study_plan.h"

namespace duet {

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
  StudyRecordings recordings;
  const std::filesystem::path file = folder / "recordings.json";
  if (!std::filesystem::exists(file)) return recordings;
  try {
    const auto json = nlohmann::ordered_json::parse(ReadTextFile(file));
    for (const auto& [key, value] : json.items()) {
      recordings[key] = {.path = value.at("path").get<std::string>(),
                         .fingerprint = value.at("fingerprint_sha256").get<std::string>(),
                         .has_images = value.at("has_images").get<bool>(),
                         .frames = value.at("frames").get<int>()};
    }
  } catch (const nlohmann::ordered_json::exception& error) {
    throw InputError(file.string(), 0, "",
                     std::string("is no list of recordings: ") + error.what());
  }
  return recordings;
}

}  // namespace duet
