#include "peers/pov_peer.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/io/pov.h"
#include "peers/program_picture.h"
#include "peers/run_program.h"

namespace linetree {
namespace {

// What core/io/pov.h says of a scene's picture.
std::vector<std::string> Differences(const Scene& scene) {
  const bool lets_through =
      std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
        return !IsBlack(scene.materials[static_cast<size_t>(object.material)].transmit);
      });
  if (!lets_through) return {};
  return {"transmitted paths end by their own grey value, and do not count unrefracted rays"};
}

class PovPeer : public Peer {
 public:
  PovPeer(const PeerSetup& setup, std::string version)
      : setup_(setup), version_(std::move(version)) {}

  std::string Version() const override { return version_; }
  std::string Timed() const override { return "its own trace time"; }

  absl::StatusOr<PeerPicture> Render(const Camera& camera, int width, int height) override {
    auto text = WritePov(*setup_.scene, camera, width, height, setup_.limits);
    if (!text.ok()) return text.status();
    ProgramRun run;
    run.words = {"povray",
                 "+Iscene.pov",
                 absl::StrCat("+O", kProgramPicture),
                 "+FP16",
                 "File_Gamma=1.0",
                 "Dither=off",
                 absl::StrCat("+W", width),
                 absl::StrCat("+H", height),
                 "-A",
                 "-D",
                 "-V",
                 absl::StrCat("+WT", setup_.threads)};
    run.scene_file = "scene.pov";
    run.scene_text = *std::move(text);
    run.time_label = "Trace Time:";
    auto picture = PictureOfProgram(run, width, height);
    if (picture.ok()) picture->differences = Differences(*setup_.scene);
    return picture;
  }

 private:
  const PeerSetup setup_;
  const std::string version_;
};

// The word after the program's name, as in "POV-Ray 3.7.0.10"; complaints may come before it.
absl::StatusOr<std::string> PovVersion() {
  const auto folder = TempFolder::Make();
  if (!folder.ok()) return folder.status();
  const auto text = RunProgramToSuccess({"povray", "--version"}, folder->path());
  if (!text.ok()) return text.status();
  const std::vector<std::string> words =
      absl::StrSplit(*text, absl::ByAnyChar(" \n"), absl::SkipEmpty());
  const auto name = std::find(words.begin(), words.end(), "POV-Ray");
  return name == words.end() || name + 1 == words.end() ? "unknown" : *(name + 1);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Peer>> MakePovPeer(const PeerSetup& setup) {
  if (!IsInstalled("povray")) {
    return absl::UnavailableError("not installed: install the package povray");
  }
  auto version = PovVersion();
  if (!version.ok()) return version.status();
  return std::make_unique<PovPeer>(setup, *std::move(version));
}

}  // namespace linetree
