#include "peers/program_picture.h"

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/io/atomic_file.h"
#include "core/io/ppm.h"
#include "core/io/read_file.h"
#include "core/render/options.h"
#include "peers/run_program.h"

namespace linetree {
namespace {

// A header and six bytes for each of the largest picture's pixels.
constexpr uint64_t kMaxPictureBytes = RenderLimits{}.max_pixels * 6 + 4096;

absl::StatusOr<std::vector<float>> ReadPicture(const std::string& path, int width, int height) {
  const auto bytes = ReadFileAtMost(path, kMaxPictureBytes);
  if (!bytes.ok()) return bytes.status();
  const auto picture = ParsePpm16(*bytes);
  if (!picture.ok()) return picture.status();
  if (picture->width != width || picture->height != height) {
    return absl::UnknownError(absl::StrCat("expected ", width, " x ", height, " pixels, found ",
                                           picture->width, " x ", picture->height));
  }
  std::vector<float> radiance;
  radiance.reserve(3 * picture->pixels.size());
  for (const Rgb& pixel : picture->pixels) {
    for (int i = 0; i < 3; ++i) radiance.push_back(static_cast<float>(pixel[i]));
  }
  return radiance;
}

}  // namespace

absl::StatusOr<double> SecondsInLog(const std::string& log, const std::string& label) {
  for (absl::string_view line : absl::StrSplit(log, absl::ByAnyChar("\r\n"))) {
    line = absl::StripAsciiWhitespace(line);
    if (!absl::ConsumePrefix(&line, label)) continue;
    const size_t end = line.rfind("seconds");
    if (end == absl::string_view::npos) continue;
    line = absl::StripTrailingAsciiWhitespace(line.substr(0, end));
    const size_t start = line.find_last_of(" \t(:");
    double seconds = 0;
    if (absl::SimpleAtod(line.substr(start == absl::string_view::npos ? 0 : start + 1), &seconds)) {
      return seconds;
    }
  }
  return absl::UnknownError(
      absl::StrCat("expected a line '", label, " ... seconds' in its output"));
}

absl::StatusOr<PeerPicture> PictureOfProgram(const ProgramRun& run, int width, int height) {
  const auto folder = TempFolder::Make();
  if (!folder.ok()) return folder.status();
  if (auto s = WriteFileAtomically(folder->File(run.scene_file), run.scene_text); !s.ok()) return s;
  const auto log = RunProgramToSuccess(run.words, folder->path());
  if (!log.ok()) return log.status();
  const auto named = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat(run.words[0], ": ", status.message()));
  };
  const auto seconds = SecondsInLog(*log, run.time_label);
  if (!seconds.ok()) return named(seconds.status());
  auto radiance = ReadPicture(folder->File(kProgramPicture), width, height);
  if (!radiance.ok()) return named(radiance.status());
  PeerPicture picture;
  picture.seconds = *seconds;
  picture.radiance = *std::move(radiance);
  return picture;
}

}  // namespace linetree
