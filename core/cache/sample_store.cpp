#include "core/cache/sample_store.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <utility>
#include <vector>

namespace linetree {
namespace {

// What make_shared puts beside the object: a virtual table pointer and two counts.
constexpr uint64_t kControlBlockBytes = 16;

// Room is made when less than an eighth of the limit is left, and then half of it.
constexpr uint64_t kLowWater = 8;

}  // namespace

SampleStore::Sample SampleStore::Get(const SampleKey& key) const {
  const auto it = entries_.find(key);
  if (it == entries_.end()) return nullptr;
  std::atomic_ref<uint32_t>(it->second.used).store(round_, std::memory_order_relaxed);
  return it->second.sample;
}

void SampleStore::Put(const SampleKey& key, Sample sample) {
  Entry entry{std::move(sample), round_};
  const uint64_t bytes = BytesOf(entry);
  if (ByteSize() + bytes + GrowthBytes() > limit_bytes_) return;
  if (entries_.try_emplace(key, std::move(entry)).second) sample_bytes_ += bytes;
}

uint64_t SampleStore::BytesOf(const Entry& entry) {
  return entry.sample->ByteSize() + kControlBlockBytes;
}

// The slots and one control byte for each.
uint64_t SampleStore::TableBytes() const {
  return entries_.capacity() * (sizeof(std::pair<const SampleKey, Entry>) + 1);
}

// What the table grows by when one more entry comes: it doubles at a load of 7/8.
uint64_t SampleStore::GrowthBytes() const {
  constexpr uint64_t kFirstTable = 8 * (sizeof(std::pair<const SampleKey, Entry>) + 1);
  const uint64_t capacity = entries_.capacity();
  if (entries_.size() + 1 < capacity - capacity / 8) return 0;
  return std::max(TableBytes(), kFirstTable) + kFirstTable;
}

template <class F>
void SampleStore::DropIf(F condition) {
  absl::flat_hash_map<SampleKey, Entry> kept;
  sample_bytes_ = 0;
  for (auto& [key, entry] : entries_) {
    if (condition(key, entry)) continue;
    sample_bytes_ += BytesOf(entry);
    kept.emplace(key, std::move(entry));
  }
  entries_ = std::move(kept);  // a new table, because erasing alone would not give memory back
}

void SampleStore::EndRound() {
  ++round_;
  if (ByteSize() + GrowthBytes() <= limit_bytes_ - limit_bytes_ / kLowWater) return;
  // A slot may cost twice its size after the table's next doubling.
  constexpr uint64_t kSlotBytes = 2 * (sizeof(std::pair<const SampleKey, Entry>) + 1);
  std::vector<std::pair<uint32_t, uint64_t>> by_age;  // round of last use, bytes
  by_age.reserve(entries_.size());
  for (const auto& [key, entry] : entries_) {
    by_age.emplace_back(entry.used, BytesOf(entry) + kSlotBytes);
  }
  std::sort(by_age.begin(), by_age.end(), std::greater<>());
  // Samples of one round stay or go together: those of the round at which half is reached go.
  uint64_t total = 0;
  uint32_t newest_dropped = 0;
  for (const auto& [used, size] : by_age) {
    total += size;
    newest_dropped = used;
    if (total > limit_bytes_ / 2) break;
  }
  DropIf([&](const SampleKey&, const Entry& entry) { return entry.used <= newest_dropped; });
}

void SampleStore::SetLimit(uint64_t limit_bytes) {
  limit_bytes_ = limit_bytes;
  EndRound();
}

void SampleStore::DropForest(uint32_t forest) {
  DropIf([&](const SampleKey& key, const Entry&) { return key.forest == forest; });
}

void SampleStore::Clear() {
  DropIf([](const SampleKey&, const Entry&) { return true; });
}

uint64_t SampleStore::CountBytes() const {
  uint64_t bytes = TableBytes();
  for (const auto& [key, entry] : entries_) bytes += BytesOf(entry);
  return bytes;
}

}  // namespace linetree
