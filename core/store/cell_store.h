// The cells of all scenes of a server, kept on its disk: what one process has learnt, the next one
// knows from the first frame on.
//
// Writing happens behind the caches' back: a thread takes what has gathered every second and
// commits it as one. What is odd on the disk, and a disk that is full or fails, cost what would
// have been known, and a line of the log; never an answer.
//
// Thread safety: every method may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "core/store/page_file.h"
#include "core/store/scene_pages.h"

namespace linetree {

class CellStore {
 public:
  using Log = std::function<void(const std::string& line)>;

  struct Options {
    std::string folder;
    uint64_t max_bytes = uint64_t{1} << 30;  // of the file
    std::chrono::milliseconds interval{1000};
  };

  // By which the pages of this program are told from those of others.
  static uint64_t Algorithm();

  // Errors as those of PageFile::Open. What was found odd is put aside and logged.
  static absl::StatusOr<std::unique_ptr<CellStore>> Open(const Options& options, Log log);
  // Writes what has gathered.
  ~CellStore();

  // Gives the scene's caches what was kept of it, and back what they are to tell of their cells:
  // before anybody asks them. It outlives this store, if somebody holds it, and keeps nothing then.
  std::shared_ptr<ScenePages> Attach(const std::string& name, const ScenePages::Caches& caches);

  // Returns when everything that had gathered is on the disk, or lost.
  void Flush();

  PageFile::Sizes sizes() const { return file_->SizesNow(); }
  const std::string& folder() const { return file_->folder(); }

 private:
  CellStore(const Options& options, std::unique_ptr<PageFile> file, Log log);
  void Run();
  // Takes out what other programs have kept, and the scene that was used longest ago of those that
  // nobody has loaded. False where there is nothing of that kind.
  bool MakeRoom();
  std::vector<SceneVersion> InUse();

  const Options options_;
  const std::unique_ptr<PageFile> file_;
  const Log log_;
  std::mutex write_mutex_;  // one writes at a time
  bool fails_ = false;      // guarded by write_mutex_: what was written last was lost
  std::mutex mutex_;
  std::condition_variable wake_;
  // Guarded by mutex_:
  bool stops_ = false;
  std::vector<std::shared_ptr<ScenePages>>
      scenes_;  // those that nobody else holds until they are written
  std::vector<SceneNote> notes_;
  std::thread writer_;
};

}  // namespace linetree
