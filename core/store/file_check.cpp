#include "core/store/file_check.h"

#include <fcntl.h>
#include <lmdb.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

constexpr unsigned kMostSeconds = 60;

// All bytes of all values; the sum keeps the compiler from leaving that out.
int ReadDatabase(MDB_txn* txn, MDB_dbi database, size_t pages, unsigned& sum) {
  MDB_cursor* cursor = nullptr;
  int error = mdb_cursor_open(txn, database, &cursor);
  if (error != 0) return error;
  MDB_val key{}, value{};
  while ((error = mdb_cursor_get(cursor, &key, &value, MDB_NEXT)) == 0) {
    const auto* bytes = static_cast<const unsigned char*>(value.mv_data);
    for (size_t i = 0; i < value.mv_size; ++i) sum += bytes[i];
    if (database != 0) continue;
    // The list of free pages: how many, and which.
    size_t count = 0, page = 0;
    if (value.mv_size < sizeof(count)) return MDB_CORRUPTED;
    std::memcpy(&count, bytes, sizeof(count));
    if (count >= value.mv_size / sizeof(page)) return MDB_CORRUPTED;
    for (size_t i = 1; i <= count; ++i) {
      std::memcpy(&page, bytes + i * sizeof(page), sizeof(page));
      if (page >= pages) return MDB_CORRUPTED;
    }
  }
  return error == MDB_NOTFOUND ? 0 : error;
}

int ReadAll(const char* folder) {
  MDB_env* env = nullptr;
  MDB_txn* txn = nullptr;
  int error = mdb_env_create(&env);
  if (error == 0) error = mdb_env_set_maxdbs(env, 2);
  if (error == 0) error = mdb_env_open(env, folder, MDB_RDONLY | MDB_NOLOCK, 0644);
  if (error == 0) error = mdb_txn_begin(env, nullptr, MDB_RDONLY, &txn);
  if (error != 0) return error;
  MDB_envinfo info;
  error = mdb_env_info(env, &info);
  unsigned sum = 0;
  for (const char* name : {"pages", "notes"}) {
    MDB_dbi database = 0;
    if (error == 0) error = mdb_dbi_open(txn, name, 0, &database);
    if (error == MDB_NOTFOUND) {
      error = 0;
    } else if (error == 0) {
      error = ReadDatabase(txn, database, info.me_last_pgno + 1, sum);
    }
  }
  // The list of free pages is database 0.
  if (error == 0) error = ReadDatabase(txn, 0, info.me_last_pgno + 1, sum);
  volatile unsigned seen = sum;
  (void)seen;
  return error;
}

[[noreturn]] void Child(const char* folder) {
  // What it says before it dies is of no use to anybody.
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  for (const int sign : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGALRM}) signal(sign, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  alarm(kMostSeconds);
  _exit(ReadAll(folder) == 0 ? 0 : 1);
}

}  // namespace

std::string OddityOf(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder + "/data.mdb", error)) return "";
  // Writers make the first page before anything else.
  if (std::filesystem::file_size(folder + "/data.mdb", error) == 0) return "";
  const pid_t child = fork();
  if (child < 0) return absl::StrCat("no process to read it: ", std::strerror(errno));
  if (child == 0) Child(folder.c_str());
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return absl::StrCat("waiting for its reader: ", std::strerror(errno));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return "expected a database that can be read to its end, and it cannot";
}

absl::Status PutAside(const std::string& folder) {
  std::error_code error;
  std::filesystem::rename(folder + "/data.mdb", folder + "/data.mdb.odd", error);
  // Readers' places in it mean nothing to the next one.
  std::error_code ignored;
  std::filesystem::remove(folder + "/lock.mdb", ignored);
  if (!error) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(folder, "/data.mdb: renaming it: ", error.message()));
}

}  // namespace linetree
