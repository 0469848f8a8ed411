// Packets against the scalar tracer on every scene that is shipped.
#include <filesystem>

#include "core/io/load_scene.h"
#include "tests/packet/packet_check.h"

namespace linetree::test {
namespace {

TEST(Scenes, EveryPixelHasTheSameTree) {
  std::vector<std::string> files;
  for (const char* folder : {"scenes", "scenes/spd"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::string(LINETREE_SOURCE_DIR "/") + folder)) {
      const std::string extension = entry.path().extension();
      if (extension == ".textproto" || extension == ".nff") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 20u);
  for (const std::string& file : files) {
    const auto scene = LoadSceneFile(file);
    ASSERT_TRUE(scene.ok()) << scene.status();
    const Tracer tracer(**scene);
    const PacketTracer packets(tracer);
    EXPECT_TRUE(packets.IsWide()) << file;
    CheckTotals totals;
    CheckPicture(packets, (*scene)->cameras[0], 96, 70, {}, file, totals);
    Print(std::filesystem::path(file).filename().c_str(), totals);
    EXPECT_EQ(totals.wrong, 0u);
  }
}

}  // namespace
}  // namespace linetree::test
