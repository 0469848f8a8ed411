#include "core/store/page_file.h"

#include <fcntl.h>
#include <lmdb.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "core/store/bytes.h"
#include "core/store/file_check.h"

namespace linetree {
namespace {

constexpr const char* kPages = "pages";
constexpr const char* kNotes = "notes";
constexpr size_t kVersionDigits = 32;
// A sixteenth of the file is left for taking pages out, which takes room itself.
constexpr uint64_t kReserve = 16;

absl::Status Failed(const std::string& folder, const char* what, int error) {
  const std::string message = absl::StrCat(folder, ": ", what, ": ", mdb_strerror(error));
  switch (error) {
    case MDB_MAP_FULL:
    case ENOSPC:
    case EFBIG:
    case EDQUOT:
      return absl::ResourceExhaustedError(message);
    case EACCES:
    case EROFS:
      return absl::PermissionDeniedError(message);
    case ENOENT:
      return absl::NotFoundError(message);
    default:
      return absl::UnavailableError(message);
  }
}

MDB_val ValueOf(std::string_view bytes) { return {bytes.size(), const_cast<char*>(bytes.data())}; }
std::string_view BytesOf(const MDB_val& value) {
  return {static_cast<const char*>(value.mv_data), value.mv_size};
}

// Numbers so that keys are in their order.
void PutBigEndian(uint64_t value, std::string& out) {
  for (int shift = 56; shift >= 0; shift -= 8) out.push_back(static_cast<char>(value >> shift));
}
uint64_t GetBigEndian(std::string_view bytes) {
  uint64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<uint8_t>(c);
  return value;
}

std::string PrefixOf(const SceneVersion& scene, uint64_t algorithm) {
  std::string key = scene.substr(0, kVersionDigits);
  key.resize(kVersionDigits, ' ');
  PutBigEndian(algorithm, key);
  return key;
}
std::string BytesOf(const PageKey& key) {
  std::string bytes = PrefixOf(key.scene, key.algorithm);
  PutBigEndian(key.number, bytes);
  return bytes;
}
// False where it is no key of a page.
bool ParseKey(std::string_view bytes, PageKey& key) {
  if (bytes.size() != kVersionDigits + 16) return false;
  key.scene = std::string(bytes.substr(0, kVersionDigits));
  key.algorithm = GetBigEndian(bytes.substr(kVersionDigits, 8));
  key.number = GetBigEndian(bytes.substr(kVersionDigits + 8));
  return true;
}

// A transaction that is given up unless it is committed.
class Transaction {
 public:
  Transaction(MDB_env* env, unsigned flags) { error_ = mdb_txn_begin(env, nullptr, flags, &txn_); }
  ~Transaction() {
    if (txn_ != nullptr) mdb_txn_abort(txn_);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  int error() const { return error_; }
  MDB_txn* get() const { return txn_; }
  int Commit() { return mdb_txn_commit(std::exchange(txn_, nullptr)); }

 private:
  MDB_txn* txn_ = nullptr;
  int error_ = 0;
};

// Files that were just made are there after a crash only when their folder is written, too.
void SyncFolder(const std::string& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

// A lock on all of it, of whoever has opened it.
struct flock WholeFile() {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

absl::Status MakeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Failed(folder, "making the folder", error.value());
  SyncFolder(std::filesystem::path(folder).parent_path().string());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<PageFile>> PageFile::Open(const std::string& folder,
                                                         uint64_t max_bytes, Access access,
                                                         std::string* found_odd) {
  std::unique_ptr<PageFile> file(new PageFile(folder, max_bytes));
  if (access == Access::kWrite) {
    if (auto status = MakeFolder(folder); !status.ok()) return status;
    if (auto status = file->Lock(); !status.ok()) return status;
  }
  // What another process writes it has read itself, and changes while it is read.
  const bool is_written = access == Access::kReadOnly && file->IsWritten();
  const auto odd = is_written ? absl::StatusOr<std::string>("") : OddityOf(folder);
  if (!odd.ok()) return odd.status();
  if (!odd->empty()) {
    const std::string message = absl::StrCat(folder, "/data.mdb: ", *odd);
    if (access == Access::kReadOnly) return absl::DataLossError(message);
    const auto name = PutAside(folder);
    if (!name.ok()) return name.status();
    if (found_odd != nullptr) *found_odd = absl::StrCat(message, "; it is now ", *name);
  }
  if (auto status = file->Start(access); !status.ok()) return status;
  if (access == Access::kWrite) SyncFolder(folder);
  return file;
}

absl::Status PageFile::Lock() {
  const std::string name = folder_ + "/writer.lock";
  lock_ = open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) return Failed(folder_, "opening writer.lock", errno);
  struct flock lock = WholeFile();
  if (fcntl(lock_, F_OFD_SETLK, &lock) == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(folder_, ": another process keeps its cells there"));
}

bool PageFile::IsWritten() const {
  const int fd = open((folder_ + "/writer.lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  // Looks without taking it.
  struct flock lock = WholeFile();
  const bool is_known = fcntl(fd, F_OFD_GETLK, &lock) == 0;
  close(fd);
  return is_known && lock.l_type != F_UNLCK;
}

absl::Status PageFile::Start(Access access) {
  const bool reads = access == Access::kReadOnly;
  int error = mdb_env_create(&env_);
  if (error == 0) error = mdb_env_set_maxdbs(env_, 2);
  if (error == 0 && !reads) error = mdb_env_set_mapsize(env_, max_);
  if (error == 0) {
    error = mdb_env_open(env_, folder_.c_str(), MDB_NOTLS | (reads ? MDB_RDONLY : 0U), 0644);
  }
  if (error != 0) return Failed(folder_, "opening data.mdb", error);
  Transaction txn(env_, reads ? MDB_RDONLY : 0);
  error = txn.error();
  const unsigned make = reads ? 0 : MDB_CREATE;
  if (error == 0) error = mdb_dbi_open(txn.get(), kPages, make, &pages_);
  if (error == 0) error = mdb_dbi_open(txn.get(), kNotes, make, &notes_);
  if (error == 0) error = txn.Commit();
  if (error == MDB_NOTFOUND) {
    return absl::NotFoundError(absl::StrCat(folder_, ": no pages have been kept there"));
  }
  return error == 0 ? absl::OkStatus() : Failed(folder_, "opening data.mdb", error);
}

PageFile::~PageFile() {
  if (env_ != nullptr) mdb_env_close(env_);
  if (lock_ >= 0) close(lock_);
}

absl::Status PageFile::Write(std::span<const PageWrite> pages, std::span<const SceneNote> notes) {
  uint64_t bytes = 0;
  for (const PageWrite& write : pages) bytes += write.page.size();
  const std::lock_guard lock(write_mutex_);
  // Readers that were killed would keep what they have seen from being used again.
  mdb_reader_check(env_, nullptr);
  if (SizesNow().used_bytes + bytes > max_ - max_ / kReserve) {
    return absl::ResourceExhaustedError(
        absl::StrCat(folder_, ": writing pages: no room in ", max_, " bytes"));
  }
  Transaction txn(env_, 0);
  int error = txn.error();
  for (const PageWrite& write : pages) {
    if (error != 0) break;
    const std::string key_bytes = BytesOf(write.key);
    MDB_val key = ValueOf(key_bytes), value = ValueOf(write.page);
    error = mdb_put(txn.get(), pages_, &key, &value, 0);
  }
  for (const SceneNote& note : notes) {
    if (error != 0) break;
    std::string bytes;
    ByteWriter(bytes).Put(note.last_used);
    bytes += note.name;
    MDB_val key = ValueOf(note.scene), value = ValueOf(bytes);
    error = mdb_put(txn.get(), notes_, &key, &value, 0);
  }
  if (error == 0) error = txn.Commit();
  return error == 0 ? absl::OkStatus() : Failed(folder_, "writing pages", error);
}

absl::Status PageFile::ForEach(const SceneVersion& scene, uint64_t algorithm,
                               const Visit& visit) const {
  return ForEachFrom(PrefixOf(scene, algorithm), visit);
}
absl::Status PageFile::ForEach(const Visit& visit) const { return ForEachFrom("", visit); }

template <class Fn>
absl::Status PageFile::ForEachEntry(uint32_t database, std::string_view prefix, const char* what,
                                    Fn&& visit) const {
  const Transaction txn(env_, MDB_RDONLY);
  if (txn.error() != 0) return Failed(folder_, what, txn.error());
  MDB_cursor* cursor = nullptr;
  int error = mdb_cursor_open(txn.get(), database, &cursor);
  if (error != 0) return Failed(folder_, what, error);
  const absl::Cleanup close = [&] { mdb_cursor_close(cursor); };
  MDB_val key = ValueOf(prefix), value{};
  for (error = mdb_cursor_get(cursor, &key, &value, prefix.empty() ? MDB_FIRST : MDB_SET_RANGE);
       error == 0; error = mdb_cursor_get(cursor, &key, &value, MDB_NEXT)) {
    if (BytesOf(key).substr(0, prefix.size()) != prefix) break;
    visit(BytesOf(key), BytesOf(value));
  }
  if (error == 0 || error == MDB_NOTFOUND) return absl::OkStatus();
  return Failed(folder_, what, error);
}

absl::Status PageFile::ForEachFrom(std::string_view prefix, const Visit& visit) const {
  return ForEachEntry(pages_, prefix, "reading pages",
                      [&](std::string_view key, std::string_view value) {
                        PageKey page;
                        if (ParseKey(key, page)) visit(page, value);
                      });
}

absl::StatusOr<std::vector<SceneNote>> PageFile::Notes() const {
  std::vector<SceneNote> notes;
  const auto status =
      ForEachEntry(notes_, "", "reading notes", [&](std::string_view key, std::string_view value) {
        ByteReader in(value);
        SceneNote note;
        note.scene = std::string(key);
        note.last_used = in.Get<int64_t>();
        if (!in.ok()) return;
        note.name = std::string(value.substr(sizeof(int64_t)));
        notes.push_back(std::move(note));
      });
  if (!status.ok()) return status;
  return notes;
}

absl::StatusOr<uint64_t> PageFile::Erase(const Drops& drops, std::span<const SceneVersion> in_use) {
  std::vector<std::string> dropped;
  absl::flat_hash_set<SceneVersion> kept(in_use.begin(), in_use.end());
  auto status = ForEach([&](const PageKey& key, std::string_view page) {
    if (drops(key, page)) {
      dropped.push_back(BytesOf(key));
    } else {
      kept.insert(key.scene);
    }
  });
  if (!status.ok()) return status;
  const auto notes = Notes();
  if (!notes.ok()) return notes.status();
  const std::lock_guard lock(write_mutex_);
  Transaction txn(env_, 0);
  int error = txn.error();
  const auto erase = [&](unsigned database, std::string_view bytes) {
    if (error != 0) return;
    MDB_val key = ValueOf(bytes);
    error = mdb_del(txn.get(), database, &key, nullptr);
    if (error == MDB_NOTFOUND) error = 0;
  };
  for (const std::string& key : dropped) erase(pages_, key);
  for (const SceneNote& note : *notes) {
    if (!kept.contains(note.scene)) erase(notes_, note.scene);
  }
  if (error == 0) error = txn.Commit();
  if (error == 0) error = AgeFreePages();
  if (error != 0) return Failed(folder_, "taking pages out", error);
  return dropped.size();
}

// What one transaction frees only the one after the next may use.
int PageFile::AgeFreePages() {
  Transaction txn(env_, 0);
  int error = txn.error();
  MDB_val key = ValueOf("nothing"), value = ValueOf("");
  if (error == 0) error = mdb_put(txn.get(), notes_, &key, &value, 0);
  if (error == 0) error = mdb_del(txn.get(), notes_, &key, nullptr);
  return error == 0 ? txn.Commit() : error;
}

PageFile::Sizes PageFile::SizesNow() const {
  Sizes sizes;
  std::error_code error;
  const auto bytes = std::filesystem::file_size(folder_ + "/data.mdb", error);
  if (!error) sizes.file_bytes = bytes;
  const Transaction txn(env_, MDB_RDONLY);
  for (const unsigned database : {pages_, notes_}) {
    MDB_stat stat;
    if (txn.error() != 0 || mdb_stat(txn.get(), database, &stat) != 0) continue;
    sizes.used_bytes +=
        stat.ms_psize * (stat.ms_branch_pages + stat.ms_leaf_pages + stat.ms_overflow_pages);
  }
  return sizes;
}

}  // namespace linetree
