#pragma once

#include <string>
#include <string_view>

namespace duet {

/// How text of records (file names, reasons, settings: anything) gets into a page without being
/// taken for part of it.

/// As the text of an element or as an attribute in double quotes. Bytes that are no UTF-8 become
/// U+FFFD, and so does NUL.
[[nodiscard]] std::string EscapeHtml(std::string_view text);

/// JSON as the text of a <script> element: the same value, without a character that could end the
/// element.
[[nodiscard]] std::string EscapeScriptJson(std::string_view json);

/// RFC 4648 with padding, no line ends.
[[nodiscard]] std::string Base64(std::string_view bytes);

/// The source of a Content-Security-Policy that allows exactly this script or style.
[[nodiscard]] std::string ContentHash(std::string_view text);

}  // namespace duet
