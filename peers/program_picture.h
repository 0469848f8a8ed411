// Pictures by programs that read a scene file and write a 16-bit PPM.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "peers/peer.h"

namespace linetree {

struct ProgramRun {
  // Program and arguments; run where scene_file is, leaves kProgramPicture there.
  std::vector<std::string> words;
  std::string scene_file, scene_text;
  // What the program writes before the time that it took for the picture, on a line that ends with
  // "<number> seconds" or "(<number> seconds)".
  std::string time_label;
};
inline constexpr char kProgramPicture[] = "picture.ppm";

// Writes the scene into a temporary folder, runs the program there and reads what it left. Errors
// name the program, with its last lines.
absl::StatusOr<PeerPicture> PictureOfProgram(const ProgramRun& run, int width, int height);

// The last number before "seconds" on the line of `log` that starts with `label` (blanks aside); an
// error when there is none.
absl::StatusOr<double> SecondsInLog(const std::string& log, const std::string& label);

}  // namespace linetree
