#include "core/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

absl::Status WriteError(const std::string& path, int error) {
  return absl::ErrnoToStatus(error, absl::StrCat("cannot write ", path));
}

absl::Status WriteAll(int file, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return WriteError(path, errno);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status WriteDirectly(const std::string& path, std::string_view bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return WriteError(path, errno);
  absl::Status status = WriteAll(file, bytes, path);
  if (close(file) != 0 && status.ok()) status = WriteError(path, errno);
  return status;
}

// Creates a file that nobody else has in the folder of `path`. Its permissions are those of any new
// file. The name is short, so that names of any length that the system allows can be written.
int CreateBeside(const std::string& path, std::string& temporary) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (int attempt = 0;; ++attempt) {
    temporary = folder / absl::StrCat(".linetree.", getpid(), ".", attempt, ".tmp");
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
}

// `mode` is that of the file to be replaced, if there is one.
absl::Status WriteAndRename(const std::string& path, std::string_view bytes,
                            std::optional<mode_t> mode) {
  std::string temporary;
  const int file = CreateBeside(path, temporary);
  if (file < 0) return WriteError(path, errno);
  absl::Cleanup discard = [&] { unlink(temporary.c_str()); };
  absl::Status status = WriteAll(file, bytes, path);
  if (status.ok() && mode && fchmod(file, *mode) != 0) status = WriteError(path, errno);
  if (status.ok() && fsync(file) != 0) status = WriteError(path, errno);
  if (close(file) != 0 && status.ok()) status = WriteError(path, errno);
  if (!status.ok()) return status;
  if (rename(temporary.c_str(), path.c_str()) != 0) return WriteError(path, errno);
  std::move(discard).Cancel();
  return absl::OkStatus();
}

}  // namespace

absl::Status WriteFileAtomically(const std::string& path, std::string_view bytes) {
  struct stat present {};
  if (stat(path.c_str(), &present) != 0) {
    if (errno != ENOENT) return WriteError(path, errno);
    return WriteAndRename(path, bytes, std::nullopt);
  }
  if (S_ISDIR(present.st_mode)) return WriteError(path, EISDIR);
  if (!S_ISREG(present.st_mode)) return WriteDirectly(path, bytes);
  // A symbolic link keeps pointing where it does: the file that it names is replaced.
  std::error_code error;
  const std::string target = std::filesystem::canonical(path, error).string();
  if (error) return WriteError(path, error.value());
  return WriteAndRename(target, bytes, present.st_mode & static_cast<mode_t>(07777));
}

}  // namespace linetree
