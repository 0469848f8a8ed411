// The scenes of a server by name, each with its cache.
//
// A host that is in use outlives its unloading: whoever holds it finishes with it. The caches share
// one budget by the scenes' weights; their parts change when scenes come and go.
// Thread safety: all methods may be called from any thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/live_audit.h"
#include "core/render/scene_host.h"
#include "core/store/cell_store.h"
#include "server/answer_counts.h"

namespace linetree {

struct NamedHost {
  std::string name;
  std::shared_ptr<SceneHost> host;
  std::shared_ptr<AuditCounts> audit;       // of this host's answers
  std::shared_ptr<AnswerCounts> answers{};  // of this host's answers, too
  double weight = 1;                        // its caches' part of the budget, by the sum of all
  uint64_t memory_bytes = 0;                // that is, when this was looked up
  // The scene's message, serialized, which edits start from.
  std::shared_ptr<const std::string> content{};
  // What the host took over from the one that it replaced.
  Adopted adopted{};
  double adopt_ms = 0;
  // What is kept of it on the disk; null: nothing.
  std::shared_ptr<const ScenePages> pages{};
};

inline constexpr double kMinSceneWeight = 1e-3, kMaxSceneWeight = 1e3;

// How scenes' caches evict, and who records what they are asked for (null: nobody).
struct SceneEviction {
  std::string policy = kDefaultPolicy;
  TraceRecorder* recorder = nullptr;
};

class SceneStore {
 public:
  struct Limits {
    size_t max_scenes = 256;
    uint64_t max_objects = 16'000'000;          // in all scenes together
    uint64_t memory_bytes = uint64_t{1} << 30;  // for the caches of all scenes together
  };

  // `cells` is where the scenes' cells are kept, and outlives the store; null: nowhere.
  explicit SceneStore(const Limits& limits, SceneEviction eviction = {}, CellStore* cells = nullptr)
      : limits_(limits), eviction_(std::move(eviction)), cells_(cells) {}

  // Keeps the scene under `name`. The same content again keeps the warm cache; other content is
  // ALREADY_EXISTS unless `replace`: then it takes over what is known of all that is the same in
  // both, and frames that are under way in the former scene go on without a cache.
  // RESOURCE_EXHAUSTED when the store is full; all is then as it was. Without a `weight`, which
  // lies between the bounds above, the scene keeps that of the name, or gets 1. One call at a time.
  absl::StatusOr<NamedHost> Add(const std::string& name, std::shared_ptr<const Scene> scene,
                                bool replace, std::shared_ptr<const std::string> content = nullptr,
                                std::optional<double> weight = std::nullopt);

  // INVALID_ARGUMENT for what is no name, NOT_FOUND for an unknown one; `path` names the field.
  absl::StatusOr<NamedHost> Find(const std::string& name, absl::string_view path) const;

  // By name.
  std::vector<NamedHost> All() const;

  absl::Status Remove(const std::string& name, absl::string_view path);

  // Tells which names come (true) and go (false), those that are there already first. Called with a
  // lock held: it must not call the store. Null: nobody is told any more.
  using OnChange = std::function<void(const std::string& name, bool there)>;
  void Observe(OnChange on_change);

 private:
  using Hosts = std::map<std::string, NamedHost>;

  // What to replace (nothing: a null host), or why the scene cannot be added.
  absl::StatusOr<NamedHost> CheckAdd(const std::string& name, const Scene& scene,
                                     bool replace) const;
  absl::Status CheckRoom(const Hosts::const_iterator& replaced, const Scene& scene) const;
  // Of this name's weight beside the weights of all other names.
  uint64_t ShareOf(const NamedHost& scene) const;
  uint64_t PartOf(double weight, double sum) const;
  void ShareMemory();  // needs mutex_
  absl::Status Unknown(const std::string& name, absl::string_view path) const;

  // Gives a new host what is kept of its scene, and keeps what it learns.
  void KeepCells(NamedHost& scene) const;

  const Limits limits_;
  const SceneEviction eviction_;
  CellStore* const cells_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  Hosts hosts_;
  OnChange on_change_;
};

}  // namespace linetree
