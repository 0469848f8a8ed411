#include "core/store/file_check.h"

#include <fcntl.h>
#include <lmdb.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

// Of the child: more than the slowest disk needs.
constexpr unsigned kLeastSeconds = 60;
constexpr uint64_t kBytesPerSecond = 2 << 20;

// How the child ends. Sanitizers end a program that goes astray with 1.
constexpr int kReadsWell = 0;
constexpr int kIsOdd = 1;
constexpr int kCannotTell = 2;

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

// LMDB's own errors are negative. A file that says it is huge finds no room or no sense in it.
int ExitOf(int error) {
  if (error == 0) return kReadsWell;
  return error < 0 || error == EINVAL || error == ENOMEM ? kIsOdd : kCannotTell;
}

[[noreturn]] void Child(const char* folder, unsigned seconds) {
  // What it says before it dies is of no use to anybody.
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  for (const int sign : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGALRM}) signal(sign, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  alarm(seconds);
  _exit(ExitOf(ReadAll(folder)));
}

}  // namespace

absl::StatusOr<std::string> OddityOf(const std::string& folder) {
  const std::string file = folder + "/data.mdb";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return "";
  const uint64_t bytes = std::filesystem::file_size(file, error);
  // Writers make the first page before anything else.
  if (bytes == 0) return "";
  const auto cannot_tell = [&](const char* why) {
    return absl::UnavailableError(
        absl::StrCat(file, ": cannot tell whether it can be read to its end: ", why));
  };
  // Whoever ignores its children, which is inherited, would not hear of this one.
  struct sigaction former;
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  sigaction(SIGCHLD, &usual, &former);
  const absl::Cleanup restore = [&] { sigaction(SIGCHLD, &former, nullptr); };
  const pid_t child = fork();
  if (child < 0) return cannot_tell(std::strerror(errno));
  if (child == 0) {
    Child(folder.c_str(), kLeastSeconds + static_cast<unsigned>(bytes / kBytesPerSecond));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return cannot_tell(std::strerror(errno));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kReadsWell) return "";
  const int sign = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  const bool went_astray =
      sign == SIGSEGV || sign == SIGBUS || sign == SIGABRT || sign == SIGFPE || sign == SIGILL;
  if (went_astray || (WIFEXITED(status) && WEXITSTATUS(status) == kIsOdd)) {
    return "expected a database that can be read to its end, and it cannot";
  }
  return cannot_tell(sign == SIGALRM ? "it takes too long" : "its reader was refused or ended");
}

absl::StatusOr<std::string> PutAside(const std::string& folder) {
  std::error_code error;
  std::string name = "data.mdb.odd";
  for (int i = 1; std::filesystem::exists(folder + "/" + name, error); ++i) {
    name = absl::StrCat("data.mdb.odd", i);
  }
  std::filesystem::rename(folder + "/data.mdb", folder + "/" + name, error);
  // Readers' places in it mean nothing to the next one.
  std::error_code ignored;
  std::filesystem::remove(folder + "/lock.mdb", ignored);
  if (!error) return name;
  return absl::UnavailableError(absl::StrCat(folder, "/data.mdb: renaming it: ", error.message()));
}

}  // namespace linetree
