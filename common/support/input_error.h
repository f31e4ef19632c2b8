#pragma once

#include <stdexcept>
#include <string>

namespace duet {

/// Bad input: a file, a key or a flag that is not what it has to be. Thrown by libraries, caught
/// only in main(), where it becomes one line on stderr and exit status 2.
///
/// `what()` reads "FILE:LINE: KEY: TEXT" with the parts that are known.
class InputError : public std::runtime_error {
 public:
  /// `line` counts from 1; 0 where there is none. `file` and `key` may be empty.
  InputError(const std::string& file, int line, const std::string& key, const std::string& text);
  explicit InputError(const std::string& text) : InputError("", 0, "", text) {}
};

/// A file or folder that could not be written. Becomes exit status 4.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::string& path, const std::string& text)
      : std::runtime_error(path + ": " + text) {}
};

}  // namespace duet
