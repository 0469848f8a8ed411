// Between the messages of service.proto and core types, both ways.
//
// Everything that comes from the wire is checked here or by what core offers for it; an error is
// INVALID_ARGUMENT, NOT_FOUND or RESOURCE_EXHAUSTED and starts with the path of the field at fault,
// then says what was expected. `path` arguments are prefixes of such paths: "" or, say, "frame.".
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/audit/live_audit.h"
#include "core/io/frame_codec.h"
#include "core/render/scene_host.h"
#include "core/store/scene_pages.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Names of scenes on a server: 1 to 128 of [A-Za-z0-9_.-].
inline constexpr size_t kMaxSceneName = 128;
absl::Status ValidateSceneName(absl::string_view name, absl::string_view path);

// A string from the wire, safe to print: quoted, escaped, and cut after 80 characters.
std::string Quoted(absl::string_view text);

v1::Camera CameraToWire(const Camera& camera);
// Left out: up = (0, 1, 0), fov_deg = 45. Does not validate.
Camera CameraFromWire(const v1::Camera& message);

v1::RenderOptions RenderOptionsToWire(const RenderOptions& options);
// Fields that are left out are taken from `defaults`, which must be valid.
absl::StatusOr<RenderOptions> RenderOptionsFromWire(const v1::RenderOptions& message,
                                                    const RenderOptions& defaults,
                                                    absl::string_view path);

v1::Sampling SamplingToWire(const Sampling& sampling);
// Does not validate more than that the pattern is known.
absl::StatusOr<Sampling> SamplingFromWire(const v1::Sampling& message, absl::string_view path);

// `camera_name` is sent when it is not empty, else request.camera.
v1::RenderFrameRequest FrameRequestToWire(const std::string& scene, const FrameRequest& request,
                                          const std::string& camera_name,
                                          const FrameFormat& format = {});
// `scene` is the scene that the message names. NOT_FOUND for an unknown camera name.
absl::StatusOr<FrameRequest> FrameRequestFromWire(const v1::RenderFrameRequest& message,
                                                  const Scene& scene, const RenderOptions& defaults,
                                                  const RenderLimits& limits,
                                                  absl::string_view path);

v1::TraceRaysRequest RaysToWire(const std::string& scene, const std::vector<Ray>& rays,
                                const RenderOptions& options);
// As they were sent: SceneHost::TraceRays checks them and makes directions unit length.
std::vector<Ray> RaysFromWire(const v1::TraceRaysRequest& message);

v1::TraceRaysReply RayBatchToWire(const RayBatch& batch, const SceneVersion& version);
// DATA_LOSS for an answer that no server of this version sends.
absl::StatusOr<RayBatch> RayBatchFromWire(const v1::TraceRaysReply& message);

// Both directions together lose nothing; width and height are those of a frame, else 0.
v1::FrameStats FrameStatsToWire(const FrameStats& stats, int width, int height);
FrameStats FrameStatsFromWire(const v1::FrameStats& message);

// What the host has done and holds, in sums that are kept anyway.
v1::GetStatsReply::SceneStats SceneSumsToWire(const std::string& name, SceneHost& host);
// Adds cells by verdict for the objects that have any; looks at every certified cell.
void CellVerdictsToWire(SceneHost& host, v1::GetStatsReply::SceneStats* stats);
// Both.
v1::GetStatsReply::SceneStats SceneStatsToWire(const std::string& name, SceneHost& host);

v1::GetStatsReply::AuditStats AuditStatsToWire(const AuditCounts::Values& counts);

v1::GetStatsReply::StoreStats StoreStatsToWire(const StoreCounts& counts);

v1::SceneInfo SceneInfoToWire(const std::string& name, const Scene& scene, uint64_t cache_bytes);

}  // namespace linetree
