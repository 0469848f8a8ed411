#include "tests/client/command/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

namespace linetree {
namespace {

constexpr char kListening[] = "listening on ";

std::string Content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<char*> Argv(std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  return argv;
}

std::string Program(const std::string& name) {
  return std::string(LINETREE_BINARY_DIR) + "/bin/" + name;
}

// Redirections of a child.
class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  void Open(int descriptor, const std::string& path, int flags) {
    posix_spawn_file_actions_addopen(&actions_, descriptor, path.c_str(), flags, 0600);
  }
  void Duplicate(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

nlohmann::json ReadJson(const std::string& path) {
  return nlohmann::json::parse(std::ifstream(path));
}

std::string SourceFile(const std::string& path) {
  return std::string(LINETREE_SOURCE_DIR) + "/" + path;
}

Finished RunLinetree(const std::vector<std::string>& arguments, const std::string& in) {
  TempDir dir;
  std::ofstream(dir.File("in"), std::ios::binary) << in;
  FileActions actions;
  actions.Open(STDIN_FILENO, dir.File("in"), O_RDONLY);
  actions.Open(STDOUT_FILENO, dir.File("out"), O_WRONLY | O_CREAT);
  actions.Open(STDERR_FILENO, dir.File("err"), O_WRONLY | O_CREAT);
  std::vector<std::string> all = {Program("linetree")};
  all.insert(all.end(), arguments.begin(), arguments.end());
  pid_t pid = -1;
  EXPECT_EQ(posix_spawn(&pid, all[0].c_str(), actions.get(), nullptr, Argv(all).data(), environ),
            0);
  int status = 0;
  EXPECT_EQ(waitpid(pid, &status, 0), pid);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, Content(dir.File("out")),
          Content(dir.File("err"))};
}

ServerProcess::ServerProcess(std::vector<std::string> arguments) {
  int pipe_ends[2];
  EXPECT_EQ(pipe2(pipe_ends, O_CLOEXEC), 0);
  FileActions actions;
  actions.Duplicate(pipe_ends[1], STDOUT_FILENO);
  actions.Open(STDERR_FILENO, log_.File("log"), O_WRONLY | O_CREAT);
  // Servers of tests know nothing of each other.
  if (std::find(arguments.begin(), arguments.end(), "--data-dir") == arguments.end()) {
    arguments.insert(arguments.begin(), "--no-store");
  }
  arguments.insert(arguments.begin(), {Program("linetreed"), "--listen", "127.0.0.1:0"});
  EXPECT_EQ(posix_spawn(&pid_, arguments[0].c_str(), actions.get(), nullptr, Argv(arguments).data(),
                        environ),
            0);
  close(pipe_ends[1]);
  out_ = pipe_ends[0];
  // The server says where it listens, once it does; the pipe ends if it dies before.
  std::string text;
  char c = 0;
  while (read(out_, &c, 1) == 1 && c != '\n') text += c;
  if (text.rfind(kListening, 0) == 0) address_ = text.substr(sizeof(kListening) - 1);
  EXPECT_NE(address_, "") << text << Content(log_.File("log"));
}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  close(out_);
}

}  // namespace linetree
