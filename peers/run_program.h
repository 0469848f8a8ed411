// Other people's programs: where they are, and one run of them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace linetree {

// A fresh folder below the system's folder for temporary files, removed with everything in it.
class TempFolder {
 public:
  // UNAVAILABLE with the system's reason when there can be none.
  static absl::StatusOr<TempFolder> Make();
  ~TempFolder();
  TempFolder(TempFolder&& other) noexcept : path_(std::move(other.path_)) { other.path_.clear(); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(TempFolder&&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  explicit TempFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;  // empty once moved from
};

// Whether a program of that name can be run from the folders of PATH.
bool IsInstalled(const std::string& program);

struct ProgramOutput {
  int exit_status = 0;
  std::string text;  // of both of its outputs
};

// Runs a program in `folder` to its end. UNKNOWN when it could not be started or was ended by a
// signal: the message names the program and ends with its last lines.
absl::StatusOr<ProgramOutput> RunProgram(const std::vector<std::string>& words,
                                         const std::string& folder);

// The same where another exit status than 0 is an error too; returns what the program wrote.
absl::StatusOr<std::string> RunProgramToSuccess(const std::vector<std::string>& words,
                                                const std::string& folder);

}  // namespace linetree
