#include "core/policy/clairvoyant.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace linetree {
namespace {

constexpr size_t kMostMoments = 4096;
constexpr size_t kMostSteps = 600, kLeastSteps = 30;
constexpr size_t kWork = 400'000'000;  // pairs looked at in all steps

// An item held over the moments [begin, end) saves `cost`.
struct Pair {
  uint32_t begin, end;
  double bytes, cost;
};

// The number of moments before each event and the number of all. Moment m lies before an event.
std::pair<std::vector<uint32_t>, size_t> Moments(const Trace& trace) {
  const bool all = trace.size() <= kMostMoments;
  size_t changes = 0;
  for (size_t i = 1; i < trace.size(); ++i) {
    changes += all || trace[i].time != trace[i - 1].time ? 1 : 0;
  }
  const size_t stride = std::max<size_t>(1, (changes + kMostMoments - 1) / kMostMoments);
  std::vector<uint32_t> before(trace.size());
  size_t seen = 0, count = 0;
  for (size_t i = 1; i < trace.size(); ++i) {
    if ((all || trace[i].time != trace[i - 1].time) && seen++ % stride == 0) ++count;
    before[i] = static_cast<uint32_t>(count);
  }
  return {before, count};
}

std::vector<Pair> PairsOf(const Trace& trace, const std::vector<uint32_t>& before,
                          bool ignores_size) {
  std::vector<Pair> pairs;
  std::vector<uint32_t> least(trace.size(), ~uint32_t{0});  // bytes, up to an event
  for (size_t i = 0; i < trace.size(); ++i) {
    least[i] = std::min(least[i], trace[i].bytes);
    if (trace[i].next == kNeverAgain) continue;
    const auto next = static_cast<size_t>(trace[i].next);
    least[next] = least[i];
    pairs.push_back(
        {before[i], before[next], ignores_size ? 1.0 : least[i], trace[next].rebuild_ns});
  }
  return pairs;
}

// Of all moments before each.
std::vector<double> Sums(const std::vector<double>& prices) {
  std::vector<double> sums(prices.size() + 1);
  for (size_t t = 0; t < prices.size(); ++t) sums[t + 1] = sums[t] + prices[t];
  return sums;
}

// What can be saved at most, by these prices; `held` gets the bytes that pay at each moment.
double MostSaved(std::span<const Pair> pairs, const std::vector<double>& prices, double budget,
                 std::vector<double>& held) {
  const std::vector<double> sums = Sums(prices);
  std::fill(held.begin(), held.end(), 0.0);
  double saved = budget * sums.back();
  for (const Pair& pair : pairs) {
    const double left = pair.cost - pair.bytes * (sums[pair.end] - sums[pair.begin]);
    if (left <= 0) continue;
    saved += left;
    held[pair.begin] += pair.bytes;
    held[pair.end] -= pair.bytes;
  }
  for (size_t t = 1; t < held.size(); ++t) held[t] += held[t - 1];
  return saved;
}

// The best single price: bytes and moments of all pairs that are worth more are what there is.
double UniformPrice(std::span<const Pair> pairs, double room) {
  std::vector<std::pair<double, double>> worth;  // and the room it takes
  for (const Pair& pair : pairs) {
    const double taken = pair.bytes * (pair.end - pair.begin);
    if (taken > 0) worth.emplace_back(pair.cost / taken, taken);
  }
  std::sort(worth.rbegin(), worth.rend());
  for (const auto& [price, taken] : worth) {
    room -= taken;
    if (room < 0) return price;
  }
  return 0;
}

}  // namespace

double LeastRebuildCost(const Trace& trace, uint64_t budget_bytes, bool ignores_size) {
  const auto [before, moments] = Moments(trace);
  const std::vector<Pair> pairs = PairsOf(trace, before, ignores_size);
  double all = 0, saveable = 0;
  for (const TraceEvent& event : trace) all += event.rebuild_ns;
  for (const Pair& pair : pairs) saveable += pair.cost;
  const auto budget = static_cast<double>(budget_bytes);
  if (pairs.empty() || moments == 0) return all - saveable;
  // Prices rise where more than the budget pays, and fall elsewhere, by smaller and smaller steps.
  std::vector<double> prices(moments, UniformPrice(pairs, budget * static_cast<double>(moments)));
  std::vector<double> held(moments + 1);
  const double least_price = *std::max_element(prices.begin(), prices.end()) * 1e-9;
  double saved = saveable;
  const size_t steps = std::clamp(kWork / pairs.size(), kLeastSteps, kMostSteps);
  for (size_t step = 0; step < steps; ++step) {
    saved = std::min(saved, MostSaved(pairs, prices, budget, held));
    const double rate = 0.5 / (1 + 0.1 * static_cast<double>(step));
    for (size_t t = 0; t < moments; ++t) {
      const double excess = budget > 0 ? std::clamp(held[t] / budget - 1, -1.0, 1.0) : 1.0;
      prices[t] = std::max(prices[t], least_price) * std::exp(rate * excess);
    }
  }
  return all - saved;
}

}  // namespace linetree
