// Something countable of which there is only so much: bytes of frames, places for flights.
//
// Thread safety: all methods may be called from any thread. A Budget must outlive its shares.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace linetree {

class Budget {
 public:
  explicit Budget(uint64_t total) : free_(total) {}

  // What was taken; goes back when it dies.
  class Share {
   public:
    Share(Share&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), amount_(other.amount_) {}
    Share& operator=(Share&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(amount_, other.amount_);
      return *this;
    }
    ~Share() {
      if (budget_ != nullptr) budget_->GiveBack(amount_);
    }

   private:
    friend class Budget;
    Share(Budget* budget, uint64_t amount) : budget_(budget), amount_(amount) {}
    Budget* budget_;
    uint64_t amount_;
  };

  // Nothing when there is not enough left.
  std::optional<Share> Take(uint64_t amount) {
    const std::lock_guard lock(mutex_);
    if (amount > free_) return std::nullopt;
    free_ -= amount;
    return Share(this, amount);
  }

  uint64_t free() const {
    const std::lock_guard lock(mutex_);
    return free_;
  }

 private:
  void GiveBack(uint64_t amount) {
    const std::lock_guard lock(mutex_);
    free_ += amount;
  }

  mutable std::mutex mutex_;
  uint64_t free_;
};

}  // namespace linetree
