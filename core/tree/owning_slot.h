// A place for one object that many threads may look at while it is put there or taken away.
#pragma once

#include <atomic>
#include <memory>

namespace linetree {

// What `get` returns stays valid until whoever takes it has seen to it that nobody reads it any
// more (core/cache/epoch.h). All that its maker wrote is seen by those who find it.
template <class T>
class OwningSlot {
 public:
  OwningSlot() = default;
  explicit OwningSlot(std::unique_ptr<T> object) : object_(object.release()) {}
  ~OwningSlot() { delete object_.load(std::memory_order_relaxed); }
  OwningSlot(const OwningSlot&) = delete;
  OwningSlot& operator=(const OwningSlot&) = delete;

  T* get() const { return object_.load(std::memory_order_acquire); }
  explicit operator bool() const { return get() != nullptr; }
  T& operator*() const { return *get(); }
  T* operator->() const { return get(); }

  // Puts it there where there is nothing yet; false, and nothing done, otherwise.
  bool PutFirst(std::unique_ptr<T>& object) {
    T* none = nullptr;
    if (!object_.compare_exchange_strong(none, object.get(), std::memory_order_acq_rel))
      return false;
    object.release();
    return true;
  }
  std::unique_ptr<T> Take() {
    return std::unique_ptr<T>(object_.exchange(nullptr, std::memory_order_acq_rel));
  }

 private:
  std::atomic<T*> object_{nullptr};
};

}  // namespace linetree
