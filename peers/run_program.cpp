#include "peers/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <system_error>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

constexpr size_t kLastLines = 4;

std::string ReasonOf(int error_number) { return std::generic_category().message(error_number); }

// The last lines that say something; a carriage return, as of progress meters, ends a line too.
std::string LastLines(const std::string& text) {
  std::vector<std::string> lines;
  for (absl::string_view part : absl::StrSplit(text, absl::ByAnyChar("\r\n"))) {
    const absl::string_view line = absl::StripAsciiWhitespace(part);
    if (!line.empty()) lines.emplace_back(line);
  }
  if (lines.size() > kLastLines) lines.erase(lines.begin(), lines.end() - kLastLines);
  return absl::StrJoin(lines, "\n");
}

absl::Status Failure(const std::string& program, const std::string& how, const std::string& text) {
  const std::string last = LastLines(text);
  return absl::UnknownError(
      absl::StrCat(program, " ", how, last.empty() ? ", without a word" : ": ", last));
}

// Starts a program whose two outputs go to `log`. 0, or the system's error number.
int Spawn(const std::vector<std::string>& words, const std::string& folder, const std::string& log,
          pid_t& pid) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const auto destroy = absl::MakeCleanup([&] { posix_spawn_file_actions_destroy(&actions); });
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  return posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
}

}  // namespace

absl::StatusOr<TempFolder> TempFolder::Make() {
  std::error_code error;
  const auto parent = std::filesystem::temp_directory_path(error);
  std::string name = (parent / "linetree-peers-XXXXXX").string();
  if (error || mkdtemp(name.data()) == nullptr) {
    return absl::UnavailableError(absl::StrCat("cannot make a temporary folder ", name, ": ",
                                               error ? error.message() : ReasonOf(errno)));
  }
  return TempFolder(name);
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

bool IsInstalled(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (const absl::string_view folder : absl::StrSplit(path == nullptr ? "" : path, ':')) {
    const std::string file = absl::StrCat(folder.empty() ? "." : folder, "/", program);
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file)) return true;
  }
  return false;
}

absl::StatusOr<ProgramOutput> RunProgram(const std::vector<std::string>& words,
                                         const std::string& folder) {
  const std::string log = folder + "/log";
  pid_t pid = 0;
  if (const int error = Spawn(words, folder, log, pid); error != 0) {
    return absl::UnknownError(absl::StrCat(words[0], " could not be started: ", ReasonOf(error)));
  }
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) return Failure(words[0], ReasonOf(errno), "");
  }
  auto text = ReadFileAtMost(log, std::numeric_limits<uint64_t>::max());
  if (!text.ok()) return text.status();
  if (WIFSIGNALED(status)) {
    return Failure(words[0], absl::StrCat("was ended by signal ", WTERMSIG(status)), *text);
  }
  return ProgramOutput{WEXITSTATUS(status), *std::move(text)};
}

absl::StatusOr<std::string> RunProgramToSuccess(const std::vector<std::string>& words,
                                                const std::string& folder) {
  auto output = RunProgram(words, folder);
  if (!output.ok()) return output.status();
  if (output->exit_status != 0) {
    return Failure(words[0], absl::StrCat("ended with status ", output->exit_status), output->text);
  }
  return std::move(output->text);
}

}  // namespace linetree
