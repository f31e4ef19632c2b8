#include "common/support/input_error.h"

namespace duet {
namespace {

std::string Compose(const std::string& file, int line, const std::string& key,
                    const std::string& text) {
  std::string message = file;
  if (line > 0) message += (file.empty() ? "line " : ":") + std::to_string(line);
  if (!message.empty()) message += ": ";
  if (!key.empty()) message += key + ": ";
  return message + text;
}

}  // namespace

InputError::InputError(const std::string& file, int line, const std::string& key,
                       const std::string& text)
    : std::runtime_error(Compose(file, line, key, text)) {}

}  // namespace duet
