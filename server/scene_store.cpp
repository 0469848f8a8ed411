#include "server/scene_store.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/wire.h"

namespace linetree {

absl::StatusOr<NamedHost> SceneStore::CheckAdd(const std::string& name, const Scene& scene,
                                               bool replace) const {
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(name);
  NamedHost former;
  if (found != hosts_.end()) {
    former = found->second;
    const SceneVersion& version = former.host->scene().version;
    if (version == scene.version) return former;
    if (!replace) {
      return absl::AlreadyExistsError(absl::StrCat("name: ", Quoted(name),
                                                   " holds other content (scene version ", version,
                                                   "); set replace to take its place"));
    }
  }
  if (auto status = CheckRoom(found, scene); !status.ok()) return status;
  return former;
}

absl::StatusOr<NamedHost> SceneStore::Add(const std::string& name,
                                          std::shared_ptr<const Scene> scene, bool replace,
                                          std::shared_ptr<const std::string> content,
                                          std::optional<double> weight) {
  if (auto status = ValidateSceneName(name, "name"); !status.ok()) return status;
  // Dies after the lock is released: a big cache takes its time.
  auto former = CheckAdd(name, *scene, replace);
  if (!former.ok()) return former;
  former->name = name;
  former->weight = weight.value_or(former->weight);
  if (former->host && former->host->scene().version == scene->version) {
    const std::lock_guard lock(mutex_);
    const auto found = hosts_.find(name);
    if (found == hosts_.end()) return former;  // removed meanwhile
    found->second.weight = former->weight;
    ShareMemory();
    return found->second;
  }
  const CacheOptions cache{.memory_bytes = ShareOf(*former), .policy = eviction_.policy};
  NamedHost added{name, std::make_shared<SceneHost>(std::move(scene), cache),
                  std::make_shared<AuditCounts>(), std::make_shared<AnswerCounts>(),
                  former->weight};
  added.host->RecordTo(eviction_.recorder);
  added.content = std::move(content);
  if (former->host) {
    // Outside the lock: it waits for those who read.
    const auto begin = std::chrono::steady_clock::now();
    // Whoever serves frames meanwhile has threads of its own; these live for some milliseconds.
    WorkerPool pool(0);
    added.adopted = added.host->Adopt(*former->host, pool);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    added.adopt_ms = took.count();
  }
  KeepCells(added);
  const std::lock_guard lock(mutex_);
  NamedHost& kept = hosts_[name];
  kept = std::move(added);
  ShareMemory();
  if (on_change_) on_change_(name, true);
  return kept;
}

void SceneStore::KeepCells(NamedHost& scene) const {
  if (cells_ == nullptr) return;
  SceneHost& host = *scene.host;
  const auto pages = cells_->Attach(scene.name, {host.scene(), host.surfaces(), host.paths()});
  host.Keep(pages);
  scene.pages = pages;
}

uint64_t SceneStore::ShareOf(const NamedHost& scene) const {
  const std::lock_guard lock(mutex_);
  double sum = scene.weight;
  for (const auto& [name, host] : hosts_) {
    if (name != scene.name) sum += host.weight;
  }
  return PartOf(scene.weight, sum);
}

uint64_t SceneStore::PartOf(double weight, double sum) const {
  return static_cast<uint64_t>(weight / sum * static_cast<double>(limits_.memory_bytes));
}

void SceneStore::ShareMemory() {
  double sum = 0;
  for (const auto& [name, host] : hosts_) sum += host.weight;
  for (auto& [name, host] : hosts_) {
    const uint64_t part = PartOf(host.weight, sum);
    // It waits for whoever lets the caches grow.
    if (part == std::exchange(host.memory_bytes, part)) continue;
    host.host->SetMemoryBytes(part);
  }
}

absl::Status SceneStore::CheckRoom(const Hosts::const_iterator& replaced,
                                   const Scene& scene) const {
  uint64_t objects = scene.objects.size();
  size_t scenes = 1;
  for (auto it = hosts_.begin(); it != hosts_.end(); ++it) {
    if (it == replaced) continue;
    ++scenes;
    objects += it->second.host->scene().objects.size();
  }
  if (scenes > limits_.max_scenes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("name: the server holds ", limits_.max_scenes, " scenes already"));
  }
  if (objects > limits_.max_objects) {
    return absl::ResourceExhaustedError(absl::StrCat("scene.objects: all scenes together may have ",
                                                     limits_.max_objects, ", got ", objects));
  }
  return absl::OkStatus();
}

absl::StatusOr<NamedHost> SceneStore::Find(const std::string& name, absl::string_view path) const {
  if (auto status = ValidateSceneName(name, path); !status.ok()) return status;
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(name);
  if (found == hosts_.end()) return Unknown(name, path);
  return found->second;
}

absl::Status SceneStore::Unknown(const std::string& name, absl::string_view path) const {
  return absl::NotFoundError(absl::StrCat(path, ": expected the name of one of the ", hosts_.size(),
                                          " loaded scenes, got ", Quoted(name)));
}

std::vector<NamedHost> SceneStore::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<NamedHost> all;
  for (const auto& [name, host] : hosts_) all.push_back(host);
  return all;
}

absl::Status SceneStore::Remove(const std::string& name, absl::string_view path) {
  if (auto status = ValidateSceneName(name, path); !status.ok()) return status;
  NamedHost removed;  // dies after the lock is released
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(name);
  if (found == hosts_.end()) return Unknown(name, path);
  removed = std::move(found->second);
  hosts_.erase(found);
  ShareMemory();
  if (on_change_) on_change_(name, false);
  return absl::OkStatus();
}

void SceneStore::Observe(OnChange on_change) {
  const std::lock_guard lock(mutex_);
  on_change_ = std::move(on_change);
  if (!on_change_) return;
  for (const auto& [name, host] : hosts_) on_change_(name, true);
}

}  // namespace linetree
