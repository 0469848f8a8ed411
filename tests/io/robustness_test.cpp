// Whatever the bytes: a scene or a status, never a crash. The mutations are drawn from a fixed
// seed; the sanitizer build runs them too.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "core/scene/scene.h"
#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

constexpr int kMutations = 10'000;

std::string ReadAll(const std::string& path) {
  std::ifstream file(std::string(LINETREE_SOURCE_DIR "/") + path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// What scene files are made of, and numbers that hurt.
const char* const kWords[] = {"nan",  "inf",    "-1", "0",      "1e300", "-1e-320", "{",
                              "}",    "p 3",    "pp", "sphere", "c",     "objects", "99999999999",
                              "1e30", "[1, 2]", "\"", "#",      "v",     "1e-30",   "\xff"};

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string Mutate(std::string text) {
    for (size_t edits = 1 + Below(4); edits > 0; --edits) Edit(text);
    return text;
  }

 private:
  size_t Below(size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); }

  void Edit(std::string& text) {
    if (text.empty()) return;
    const size_t at = Below(text.size());
    const size_t length = std::min(1 + Below(12), text.size() - at);
    switch (Below(6)) {
      case 0:
        text[at] = static_cast<char>(Below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, kWords[Below(std::size(kWords))]);
        break;
      case 3:
        text.insert(Below(text.size()), text.substr(at, length));
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        ReplaceNumber(text, at);
        break;
    }
  }

  // The run of number characters at or after `at` becomes one of the words.
  void ReplaceNumber(std::string& text, size_t at) {
    const char* const digits = "+-.0123456789e";
    const size_t start = text.find_first_of("0123456789", at);
    if (start == std::string::npos) return;
    const size_t end = std::min(text.find_first_not_of(digits, start), text.size());
    text.replace(start, end - start, kWords[Below(std::size(kWords))]);
  }

  std::mt19937 random_;
};

void ExpectUsable(const Scene& scene) {
  EXPECT_EQ(scene.version.size(), 32u);
  for (const Object& object : scene.objects) {
    EXPECT_TRUE(IsFinite(object.bounds.min) && IsFinite(object.bounds.max));
    EXPECT_FALSE(object.bounds.IsEmpty());
    EXPECT_LT(static_cast<size_t>(object.material), scene.materials.size());
  }
}

template <class Build>
void RunMutations(const std::string& text, unsigned seed, Build&& build) {
  ASSERT_TRUE(build(text).ok()) << build(text).status();
  Mutator mutator(seed);
  int built = 0;
  for (int i = 0; i < kMutations / 2; ++i) {
    const auto scene = build(mutator.Mutate(text));
    if (scene.ok()) {
      ++built;
      ExpectUsable(**scene);
    } else {
      EXPECT_FALSE(scene.status().message().empty());
    }
  }
  // Neither all refused nor all accepted, or the mutations test nothing.
  EXPECT_GT(built, kMutations / 100);
  EXPECT_LT(built, kMutations / 2 * 95 / 100);
}

TEST(Robustness, MutatedText) {
  const auto build = [](const std::string& text) { return BuildText(text); };
  RunMutations(ReadAll("tests/oracle/scenes/maps.textproto"), 1, build);
  RunMutations(ReadAll("tests/oracle/scenes/surfaces.textproto"), 2, build);
}

TEST(Robustness, MutatedNff) {
  const auto build = [](const std::string& text) { return BuildNff(text); };
  RunMutations(ReadAll("scenes/spd/gears_1.nff"), 3, build);
  RunMutations(ReadAll("scenes/spd/jacks_2.nff") +
                   "pp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 1 1\np 4 0 0 0 2 0 0 1 0.2 0 1 2 0\n",
               4, build);
}

}  // namespace
}  // namespace linetree
