#include "peers/tachyon_peer.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/io/tachyon.h"
#include "peers/program_picture.h"
#include "peers/run_program.h"

namespace linetree {
namespace {

class TachyonPeer : public Peer {
 public:
  TachyonPeer(const PeerSetup& setup, std::string version)
      : setup_(setup), version_(std::move(version)) {}

  std::string Version() const override { return version_; }
  std::string Timed() const override { return "its own ray tracing time"; }

  absl::StatusOr<PeerPicture> Render(const Camera& camera, int width, int height) override {
    auto scene = WriteTachyon(*setup_.scene, camera, width, height, setup_.limits);
    if (!scene.ok()) return scene.status();
    ProgramRun run;
    run.words = {"tachyon", "scene.dat",     "-format",     "PPM48",
                 "-o",      kProgramPicture, "-numthreads", absl::StrCat(setup_.threads)};
    run.scene_file = "scene.dat";
    run.scene_text = std::move(scene->text);
    run.time_label = "Ray Tracing Time:";
    auto picture = PictureOfProgram(run, width, height);
    if (picture.ok()) picture->differences = std::move(scene->differences);
    return picture;
  }

 private:
  const PeerSetup setup_;
  const std::string version_;
};

// Tachyon ends with another status than 0 when asked for its version.
absl::StatusOr<std::string> TachyonVersion() {
  const auto folder = TempFolder::Make();
  if (!folder.ok()) return folder.status();
  const auto output = RunProgram({"tachyon", "-version"}, folder->path());
  if (!output.ok()) return output.status();
  return std::string(absl::StripAsciiWhitespace(output->text));
}

}  // namespace

absl::StatusOr<std::unique_ptr<Peer>> MakeTachyonPeer(const PeerSetup& setup) {
  if (!IsInstalled("tachyon")) {
    return absl::UnavailableError("not installed: install the package tachyon");
  }
  auto version = TachyonVersion();
  if (!version.ok()) return version.status();
  return std::make_unique<TachyonPeer>(setup, *std::move(version));
}

}  // namespace linetree
