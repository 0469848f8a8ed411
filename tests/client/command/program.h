// Runs the built programs, as a user's shell would.
#pragma once

#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/temp_dir.h"

namespace linetree {

struct Finished {
  int exit_status = -1;  // -1 when a signal ended it
  std::string out;
  std::string err;
};

// `linetree` with these arguments, to its end. Standard input is `in`.
Finished RunLinetree(const std::vector<std::string>& arguments, const std::string& in = "");

// What a program wrote there.
nlohmann::json ReadJson(const std::string& path);

// A file of the source tree.
std::string SourceFile(const std::string& path);

// `linetreed` with these arguments, on a port that the system picks; stopped when destroyed.
class ServerProcess {
 public:
  explicit ServerProcess(std::vector<std::string> arguments = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  // host:port; empty when the server did not start.
  const std::string& address() const { return address_; }

 private:
  TempDir log_;
  pid_t pid_ = -1;
  int out_ = -1;
  std::string address_;
};

}  // namespace linetree
