#include "core/render/pixel_layer.h"

#include <sys/mman.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <vector>

namespace linetree {
namespace {

// Blocks are whole huge pages: one fault in place of 512, and fewer misses where tiles are written,
// each row of which is far from the next.
constexpr size_t kHugePage = size_t{2} << 20;

struct Block {
  void* memory;
  size_t bytes;
};

class IdleBlocks {
 public:
  void* Take(size_t bytes) {
    const std::lock_guard lock(mutex_);
    // The latest first: it may still be in the processor's caches.
    const auto found = std::find_if(blocks_.rbegin(), blocks_.rend(),
                                    [&](const Block& block) { return block.bytes == bytes; });
    if (found == blocks_.rend()) return nullptr;
    void* memory = found->memory;
    blocks_.erase(std::next(found).base());
    bytes_ -= bytes;
    return memory;
  }

  // Returns what has to go, in its place or because of it: what came first.
  std::vector<Block> Give(const Block& block) {
    if (block.bytes > kMostIdleLayerBytes) return {block};
    std::vector<Block> gone;
    const std::lock_guard lock(mutex_);
    blocks_.push_back(block);
    bytes_ += block.bytes;
    while (bytes_ > kMostIdleLayerBytes) {
      gone.push_back(blocks_.front());
      bytes_ -= blocks_.front().bytes;
      blocks_.erase(blocks_.begin());
    }
    return gone;
  }

  size_t bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Block> blocks_;  // guarded by mutex_: from the one that came first on
  size_t bytes_ = 0;           // guarded by mutex_
};

// Never destroyed: frames may outlive what is static.
IdleBlocks& Idle() {
  static IdleBlocks* const idle = new IdleBlocks;
  return *idle;
}

size_t RoundedUp(size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

}  // namespace

void* TakeLayerBlock(size_t bytes) {
  bytes = RoundedUp(bytes);
  if (void* idle = Idle().Take(bytes)) return idle;
  void* memory = ::operator new(bytes, std::align_val_t(kHugePage));
  madvise(memory, bytes, MADV_HUGEPAGE);  // where that is not to be had, pages are small
  return memory;
}

void GiveLayerBlock(void* block, size_t bytes) {
  for (const Block& gone : Idle().Give({block, RoundedUp(bytes)})) {
    ::operator delete(gone.memory, std::align_val_t(kHugePage));
  }
}

size_t IdleLayerBytes() { return Idle().bytes(); }

}  // namespace linetree
