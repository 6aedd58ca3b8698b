#pragma once

namespace organ_collision::io {

/// Whether this is translated with -fsanitize=address: then addresses and stacks have no usual
/// size.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
constexpr bool kAddressSanitizer = false;
#endif

}  // namespace organ_collision::io
