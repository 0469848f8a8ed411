// Memory of frames' layers: large blocks that come and go with every frame.
//
// Fresh memory costs a fault for every page and is filled with zeros, by one thread, before anybody
// renders into it: of a frame of 1920 x 1080 that was a fifth of what a cheap one takes. So layers
// start with whatever is there, and blocks that frames give back are kept for the next ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace linetree {

// Smaller blocks are left to the library's allocator.
inline constexpr size_t kLeastLayerBytes = size_t{1} << 20;
// What is kept for frames to come, of the whole process: two frames of 1920 x 1080.
inline constexpr size_t kMostIdleLayerBytes = size_t{128} << 20;

// A block of at least kLeastLayerBytes, with anything in it. Throws std::bad_alloc.
// Thread safety: may be called from any thread, as the next two.
void* TakeLayerBlock(size_t bytes);
// Gives back what was taken, which took as many bytes.
void GiveLayerBlock(void* block, size_t bytes);
// Bytes that are kept; at most kMostIdleLayerBytes.
size_t IdleLayerBytes();

// For std::vector: items that are given no value have none, as those of an array.
template <class T>
struct LayerAllocator {
  using value_type = T;

  LayerAllocator() = default;
  template <class U>
  LayerAllocator(const LayerAllocator<U>&) {}  // NOLINT: allocators convert into each other

  T* allocate(size_t count) {
    const size_t bytes = count * sizeof(T);
    if (count > PTRDIFF_MAX / sizeof(T)) throw std::bad_array_new_length();
    if (bytes < kLeastLayerBytes) return std::allocator<T>().allocate(count);
    return static_cast<T*>(TakeLayerBlock(bytes));
  }
  void deallocate(T* items, size_t count) {
    const size_t bytes = count * sizeof(T);
    if (bytes < kLeastLayerBytes) return std::allocator<T>().deallocate(items, count);
    GiveLayerBlock(items, bytes);
  }
  template <class U>
  void construct(U* item) {
    ::new (static_cast<void*>(item)) U;
  }
  template <class U, class... Args>
  void construct(U* item, Args&&... args) {
    ::new (static_cast<void*>(item)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(const LayerAllocator&, const LayerAllocator&) { return true; }
};

// One value for every pixel. After resize(n) new items have no value: they are to be written before
// they are read; resize(n, value) gives them one.
template <class T>
using PixelLayer = std::vector<T, LayerAllocator<T>>;

}  // namespace linetree
