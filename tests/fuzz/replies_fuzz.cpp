// What a server may send to a client: whatever the chunks hold, they make a whole frame or
// DATA_LOSS.
#include <google/protobuf/stubs/logging.h>

#include "core/io/wire.h"
#include "core/io/wire_frame.h"
#include "core/math/check.h"
#include "tests/fuzz/fuzz.h"

namespace linetree::fuzz {
namespace {

constexpr int kWidth = 7, kHeight = 5;

Frame SmallFrame() {
  Frame frame;
  frame.width = kWidth;
  frame.height = kHeight;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    for (int c = 0; c < 3; ++c) frame.radiance.push_back(0.01f * static_cast<float>(i));
    frame.object.push_back(i - 1);
    frame.source.push_back(static_cast<Source>(i % kSourceCount));
    frame.verdict.push_back(static_cast<Verdict>(i % kVerdictCount));
    frame.depth.push_back(static_cast<float>(i));
  }
  return frame;
}

FrameFormat FormatOf(uint8_t byte) {
  return {.all_layers = (byte & 8) != 0, .codec = static_cast<FrameCodec>(byte % 8 % 5)};
}

// Each chunk with the number of its bytes before it, in two bytes.
void Append(const std::string& chunk, std::string& input) {
  input.push_back(static_cast<char>(chunk.size() & 0xff));
  input.push_back(static_cast<char>(chunk.size() >> 8));
  input += chunk;
}

void Assemble(const FrameFormat& format, std::string_view bytes) {
  FrameAssembler assembler(kWidth, kHeight, format);
  while (bytes.size() >= 2) {
    const auto byte = [&](size_t i) { return static_cast<size_t>(bytes[i] & 0xff); };
    const size_t length = std::min(byte(0) | byte(1) << 8, bytes.size() - 2);
    v1::FrameChunk chunk;
    if (!chunk.ParseFromArray(bytes.data() + 2, static_cast<int>(length))) return;
    bytes.remove_prefix(2 + length);
    const auto status = assembler.Add(chunk);
    LT_CHECK(status.ok() || absl::IsDataLoss(status));
    if (!status.ok()) return;
    LT_CHECK(assembler.share_done() >= 0 && assembler.share_done() <= 1);
  }
  if (!assembler.complete()) return;
  const Frame frame = assembler.Take();
  const size_t pixels = kWidth * kHeight;
  const size_t shown = HoldsLayers(format.codec) ? pixels : 0;
  LT_CHECK(frame.radiance.size() == 3 * shown);
  LT_CHECK(frame.verdict.size() == (format.all_layers ? shown : 0));
  for (const Verdict verdict : frame.verdict) LT_CHECK(static_cast<int>(verdict) < kVerdictCount);
}

}  // namespace

// The first byte of an input is the format that was asked for; with its highest bit the rest is a
// batch's reply.
std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (uint8_t byte = 0; byte < 16; ++byte) {
    const FrameFormat format = FormatOf(byte);
    if (format.all_layers && !HoldsLayers(format.codec)) continue;
    auto chunks = FrameChunks::Make(SmallFrame(), format);
    LT_CHECK(chunks.ok());
    std::string& seed = seeds.emplace_back(1, static_cast<char>(byte));
    for (v1::FrameChunk chunk; chunks->Next(&chunk);) Append(chunk.SerializeAsString(), seed);
  }
  RayBatch batch;
  batch.answers.resize(3);
  seeds.push_back('\x80' + RayBatchToWire(batch, "version").SerializeAsString());
  return seeds;
}

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace linetree;                  // NOLINT(google-build-using-namespace)
  google::protobuf::SetLogHandler(nullptr);  // of what is no UTF-8
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] < 0x80) {
    fuzz::Assemble(fuzz::FormatOf(data[0]), bytes);
    return 0;
  }
  v1::TraceRaysReply reply;
  if (!reply.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return 0;
  const auto batch = RayBatchFromWire(reply);
  LT_CHECK(batch.ok() || absl::IsDataLoss(batch.status()));
  return 0;
}
