#pragma once

namespace duet::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

/// Number of seeds of a statistical test: `all`, or `sanitized` under a sanitizer, which looks for
/// faults of the code, and that is the same for every seed. The bounds hold for either.
[[nodiscard]] constexpr int Seeds(int all, int sanitized) { return kSanitized ? sanitized : all; }

}  // namespace duet::test
