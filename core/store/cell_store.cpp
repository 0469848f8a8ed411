#include "core/store/cell_store.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/store/algorithm_version.h"

namespace linetree {
namespace {

// Scenes that go for one batch of pages at most: more would not help.
constexpr int kMostTries = 8;

int64_t SecondsNow() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::seconds>(now).count();
}

}  // namespace

uint64_t CellStore::Algorithm() { return kAlgorithmVersion; }

absl::StatusOr<std::unique_ptr<CellStore>> CellStore::Open(const Options& options, Log log) {
  std::string odd;
  auto file = PageFile::Open(options.folder, options.max_bytes, PageFile::Access::kWrite, &odd);
  if (!file.ok()) return file.status();
  if (!odd.empty()) log(odd);
  return std::unique_ptr<CellStore>(new CellStore(options, *std::move(file), std::move(log)));
}

CellStore::CellStore(const Options& options, std::unique_ptr<PageFile> file, Log log)
    : options_(options), file_(std::move(file)), log_(std::move(log)), writer_([this] { Run(); }) {}

CellStore::~CellStore() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  wake_.notify_all();
  writer_.join();
  Flush();
}

std::shared_ptr<ScenePages> CellStore::Attach(const std::string& name,
                                              const ScenePages::Caches& caches) {
  const SceneVersion& version = caches.scene.version;
  // What is on its way to the disk gets there first.
  const std::lock_guard writing(write_mutex_);
  std::shared_ptr<ScenePages> pages;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& other : scenes_) {
      // The same content under another name has the same pages.
      if (other->version() == version) pages = other;
    }
    if (!pages) {
      pages = std::make_shared<ScenePages>(version, kAlgorithmVersion);
      scenes_.push_back(pages);
    }
    notes_.push_back({version, name, SecondsNow()});
  }
  std::vector<uint64_t> odd;
  const auto status =
      pages->Restore(*file_, caches, [&](uint64_t number) { odd.push_back(number); });
  if (!status.ok()) log_(absl::StrCat("cells of scene ", name, ": ", status.message()));
  if (odd.empty()) return pages;
  log_(absl::StrCat("cells of scene ", name, ": ", odd.size(),
                    " pages are not as they were written; they are left out and taken away"));
  const auto erased = file_->Erase(
      [&](const PageKey& key, std::string_view) {
        return key.scene == version && key.algorithm == kAlgorithmVersion &&
               std::find(odd.begin(), odd.end(), key.number) != odd.end();
      },
      InUse());
  if (!erased.ok()) log_(std::string(erased.status().message()));
  return pages;
}

void CellStore::Run() {
  std::unique_lock lock(mutex_);
  while (!stops_) {
    wake_.wait_for(lock, options_.interval, [&] { return stops_; });
    lock.unlock();
    Flush();
    lock.lock();
  }
}

void CellStore::Flush() {
  const std::lock_guard writing(write_mutex_);
  std::vector<std::shared_ptr<ScenePages>> scenes;
  std::vector<SceneNote> notes;
  {
    const std::lock_guard lock(mutex_);
    scenes = scenes_;
    notes = std::exchange(notes_, {});
    // What nobody holds any more learns nothing any more either.
    std::erase_if(scenes_, [](const auto& scene) { return scene.use_count() == 2; });
  }
  std::vector<PageWrite> pages;
  for (const auto& scene : scenes) {
    for (PageWrite& page : scene->Take()) pages.push_back(std::move(page));
  }
  if (pages.empty() && notes.empty()) return;
  auto status = file_->Write(pages, notes);
  for (int i = 0; i < kMostTries && absl::IsResourceExhausted(status) && MakeRoom(); ++i) {
    status = file_->Write(pages, notes);
  }
  for (const auto& scene : scenes) scene->Taken(status.ok());
  if (std::exchange(fails_, !status.ok()) == fails_) return;
  log_(status.ok() ? absl::StrCat(file_->folder(), ": cells are kept again")
                   : absl::StrCat(status.message(), "; cells are not kept until that is mended"));
}

std::vector<SceneVersion> CellStore::InUse() {
  const std::lock_guard lock(mutex_);
  std::vector<SceneVersion> versions;
  for (const auto& scene : scenes_) versions.push_back(scene->version());
  return versions;
}

bool CellStore::MakeRoom() {
  const std::vector<SceneVersion> in_use = InUse();
  const auto notes = file_->Notes();
  if (!notes.ok()) return false;
  // By version: when those were used that have pages and that nobody has loaded; unknown is long
  // ago.
  std::map<SceneVersion, int64_t> others;
  const auto status = file_->ForEach([&](const PageKey& key, std::string_view) {
    const bool is_used = std::find(in_use.begin(), in_use.end(), key.scene) != in_use.end();
    if (!is_used) others.emplace(key.scene, 0);
  });
  if (!status.ok()) return false;
  for (const SceneNote& note : *notes) {
    if (const auto found = others.find(note.scene); found != others.end()) {
      found->second = note.last_used;
    }
  }
  const auto oldest =
      std::min_element(others.begin(), others.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto erased = file_->Erase(
      [&](const PageKey& key, std::string_view) {
        return key.algorithm != kAlgorithmVersion ||
               (oldest != others.end() && key.scene == oldest->first);
      },
      in_use);
  if (!erased.ok() || *erased == 0) return false;
  log_(
      absl::StrCat(file_->folder(), ": full; ", *erased, " pages of other programs and scenes go"));
  return true;
}

}  // namespace linetree
