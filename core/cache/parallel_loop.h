// How the caches run their loops on somebody else's threads.
#pragma once

#include <cstddef>
#include <functional>

namespace linetree {

// Runs body(i) for i in [0, count), in any order, on as many threads as the caller likes.
using ParallelLoop = std::function<void(size_t count, const std::function<void(size_t)>& body)>;

}  // namespace linetree
