// Searches at random are shorter where a sanitizer watches: each case is looked at ten to thirty
// times as long, and what counts there is that every path is taken.
#pragma once

namespace linetree::test {

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
inline constexpr int kSanitizerShare = 4;
#else
inline constexpr int kSanitizerShare = 1;
#endif

}  // namespace linetree::test
