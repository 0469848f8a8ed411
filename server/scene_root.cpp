#include "server/scene_root.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

absl::Status OpenError(absl::string_view field, absl::string_view path, int error) {
  if (error == ELOOP || error == EACCES || error == EPERM) {
    return absl::PermissionDeniedError(absl::StrCat(
        field, ": expected a file that may be read, without symbolic links, got ", Quoted(path)));
  }
  return absl::NotFoundError(absl::StrCat(field, ": no such file: ", Quoted(path)));
}

// The file, or where the way to it ends.
absl::StatusOr<Descriptor> OpenBelow(const std::string& root, absl::string_view path,
                                     absl::string_view field) {
  const std::vector<std::string> steps = absl::StrSplit(path, '/');
  for (const std::string& step : steps) {
    const bool is_name =
        !step.empty() && step != "." && step != ".." && step.find('\0') == std::string::npos;
    if (!is_name) {
      return absl::PermissionDeniedError(absl::StrCat(
          field, ": expected names of folders and a file between slashes, got ", Quoted(path)));
    }
  }
  Descriptor at(open(root.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  for (size_t i = 0; i < steps.size() && at.is_open(); ++i) {
    // Without waiting for the other end of a pipe.
    const int kind = i + 1 < steps.size() ? O_PATH | O_DIRECTORY : O_RDONLY | O_NONBLOCK;
    at = Descriptor(openat(at.number(), steps[i].c_str(), kind | O_NOFOLLOW | O_CLOEXEC));
  }
  if (!at.is_open()) return OpenError(field, path, errno);
  return at;
}

}  // namespace

absl::StatusOr<std::string> ReadFileBelow(const std::string& root, absl::string_view path,
                                          uint64_t max_bytes, absl::string_view field) {
  const auto file = OpenBelow(root, path, field);
  if (!file.ok()) return file.status();
  struct stat status;
  if (fstat(file->number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, ": expected a plain file, got ", Quoted(path)));
  }
  std::string content;
  std::vector<char> block(1 << 16);
  for (;;) {
    const ssize_t got = read(file->number(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return absl::UnavailableError(absl::StrCat(field, ": cannot be read"));
    if (got == 0) return content;
    content.append(block.data(), static_cast<size_t>(got));
    if (content.size() > max_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat(field, ": expected at most ", max_bytes, " bytes in ", Quoted(path)));
    }
  }
}

}  // namespace linetree
