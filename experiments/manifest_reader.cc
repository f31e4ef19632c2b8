#include "experiments/manifest_reader.h"

#include <utility>

#include "common/support/input_error.h"

namespace duet {

using Json = nlohmann::ordered_json;

ManifestReader::ManifestReader(std::string_view json, std::string file) : file_(std::move(file)) {
  try {
    json_ = Json::parse(json);
  } catch (const Json::exception& error) {
    throw InputError(file_, 0, "", std::string("is no manifest: ") + error.what());
  }
}

const Json* ManifestReader::Find(std::string_view path) const {
  const Json* value = &json_;
  while (true) {
    const std::size_t dot = path.find('.');
    if (!value->is_object()) return nullptr;
    const auto found = value->find(std::string(path.substr(0, dot)));
    if (found == value->end()) return nullptr;
    value = &*found;
    if (dot == std::string_view::npos) return value;
    path.remove_prefix(dot + 1);
  }
}

bool ManifestReader::Has(const std::string& path) const { return Find(path) != nullptr; }

std::string ManifestReader::Text(const std::string& path) const {
  const Json* value = Find(path);
  if (value == nullptr || !value->is_string()) Fail(path, "a text");
  return value->get<std::string>();
}

double ManifestReader::Number(const std::string& path) const {
  const Json* value = Find(path);
  if (value == nullptr || !value->is_number()) Fail(path, "a number");
  return value->get<double>();
}

std::int64_t ManifestReader::Integer(const std::string& path, std::int64_t min,
                                     std::int64_t max) const {
  const Json* value = Find(path);
  const bool fits = value != nullptr && value->is_number_integer() &&
                    (!value->is_number_unsigned() ||
                     value->get<std::uint64_t>() <=
                         static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
  if (!fits || value->get<std::int64_t>() < min || value->get<std::int64_t>() > max) {
    Fail(path, "an integer from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value->get<std::int64_t>();
}

void ManifestReader::Fail(const std::string& path, const std::string& expected) const {
  throw InputError(file_, 0, path, "expected " + expected);
}

}  // namespace duet
