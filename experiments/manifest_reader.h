#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace duet {

/// Strict access to a manifest.json. Every error is an InputError that names file, key and what was
/// expected.
class ManifestReader {
 public:
  ManifestReader(std::string_view json, std::string file);

  /// Values by the keys that lead to them, joined by dots: "outcome.frames".
  [[nodiscard]] bool Has(const std::string& path) const;
  [[nodiscard]] std::string Text(const std::string& path) const;
  [[nodiscard]] double Number(const std::string& path) const;
  /// From `min` to `max`.
  [[nodiscard]] std::int64_t Integer(const std::string& path, std::int64_t min,
                                     std::int64_t max) const;
  /// From 0 to the largest int.
  [[nodiscard]] int Count(const std::string& path) const {
    return static_cast<int>(Integer(path, 0, std::numeric_limits<int>::max()));
  }

 private:
  [[nodiscard]] const nlohmann::ordered_json* Find(std::string_view path) const;
  [[noreturn]] void Fail(const std::string& path, const std::string& expected) const;

  nlohmann::ordered_json json_;
  std::string file_;
};

}  // namespace duet
