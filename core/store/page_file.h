// Pages on a disk: a folder with an LMDB database, for one process that writes and others that
// look. What a transaction has committed is there after a crash of the program or the machine; what
// was not is as if it had never been.
//
// Thread safety: every method may be called from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/scene/scene.h"

struct MDB_env;

namespace linetree {

struct PageKey {
  SceneVersion scene;
  uint64_t algorithm = 0;
  uint64_t number = 0;
};

struct PageWrite {
  PageKey key;
  std::string page;
};

// Of a scene, beside its pages.
struct SceneNote {
  SceneVersion scene;
  std::string name;       // the last that it was loaded under
  int64_t last_used = 0;  // seconds since 1970
};

class PageFile {
 public:
  enum class Access { kReadOnly, kWrite };

  // Makes the folder if need be (kWrite). What is there but cannot be read to its end
  // (file_check.h) is put aside under another name, and `found_odd` says so in a sentence; without
  // kWrite that is DATA_LOSS. FAILED_PRECONDITION where another process writes, NOT_FOUND where
  // there is nothing to read, and what the system says where it refuses.
  static absl::StatusOr<std::unique_ptr<PageFile>> Open(const std::string& folder,
                                                        uint64_t max_bytes, Access access,
                                                        std::string* found_odd = nullptr);
  ~PageFile();
  PageFile(const PageFile&) = delete;
  PageFile& operator=(const PageFile&) = delete;

  // All pages and notes, or none. RESOURCE_EXHAUSTED where max_bytes or the disk have no room.
  absl::Status Write(std::span<const PageWrite> pages, std::span<const SceneNote> notes = {});

  // visit(key, page) for all pages of the scene and algorithm in the order of their numbers; for
  // all pages. The bytes are valid during the call.
  using Visit = std::function<void(const PageKey& key, std::string_view page)>;
  absl::Status ForEach(const SceneVersion& scene, uint64_t algorithm, const Visit& visit) const;
  absl::Status ForEach(const Visit& visit) const;
  absl::StatusOr<std::vector<SceneNote>> Notes() const;

  // Takes the pages out for which drops(key, page) is true, and notes of scenes without pages, but
  // for those of `in_use`. Returns the number of pages.
  using Drops = std::function<bool(const PageKey& key, std::string_view page)>;
  absl::StatusOr<uint64_t> Erase(const Drops& drops, std::span<const SceneVersion> in_use = {});

  struct Sizes {
    uint64_t file_bytes = 0;  // of the file, which does not shrink: what is free is used again
    uint64_t used_bytes = 0;
  };
  Sizes SizesNow() const;
  const std::string& folder() const { return folder_; }

 private:
  PageFile(std::string folder, uint64_t max_bytes) : folder_(std::move(folder)), max_(max_bytes) {}
  absl::Status Start(Access access);
  absl::Status Lock();
  // By another process.
  bool IsWritten() const;
  int AgeFreePages();
  absl::Status ForEachFrom(std::string_view prefix, const Visit& visit) const;
  // visit(key, value) for what keys with the prefix name; `what` is said where that fails.
  template <class Fn>
  absl::Status ForEachEntry(uint32_t database, std::string_view prefix, const char* what,
                            Fn&& visit) const;

  const std::string folder_;
  const uint64_t max_;
  std::mutex write_mutex_;
  MDB_env* env_ = nullptr;
  int lock_ = -1;
  unsigned pages_ = 0, notes_ = 0;  // databases
};

}  // namespace linetree
