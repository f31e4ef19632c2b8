#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace duet {

/// SHA-256 of bytes that come in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Update(std::string_view bytes);
  void Update(const void* data, std::size_t size) {
    Update(std::string_view(static_cast<const char*>(data), size));
  }
  /// The digest as 64 lower-case hexadecimal digits. Afterwards the object starts anew.
  [[nodiscard]] std::string Finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string Sha256Hex(std::string_view bytes);

}  // namespace duet
