// LT_CHECK(condition): a bug in this program ends it, in every build type. Bad input is never a
// bug: it comes back as absl::Status.
#pragma once

namespace linetree {

[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);

}  // namespace linetree

#define LT_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::linetree::CheckFailed(#condition, __FILE__, __LINE__))
