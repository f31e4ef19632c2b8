#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/support/input_error.h"

namespace duet {

/// Bytes of any kind either are read or are an InputError; nothing else may happen.
template <class Reader>
int FuzzReader(const std::uint8_t* data, std::size_t size, const Reader& read) {
  try {
    read(std::string_view(reinterpret_cast<const char*>(data), size));
  } catch (const InputError&) {
  }
  return 0;
}

/// Cuts an input for a reader of two texts at the first line that is "---".
inline std::string_view TakeFirstPart(std::string_view* text) {
  constexpr std::string_view kCut = "---\n";
  const std::size_t end = text->find(kCut);
  const std::string_view first = text->substr(0, end);
  *text = end == std::string_view::npos ? std::string_view() : text->substr(end + kCut.size());
  return first;
}

}  // namespace duet
