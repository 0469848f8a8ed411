// Live flights over gRPC.
#pragma once

#include <memory>
#include <string>

#include "client/library/channel.h"
#include "client/library/live_flight.h"
#include "linetree/v1/service.grpc.pb.h"

namespace linetree {

// Caller and stub must outlive the flight. When a stream breaks, another takes over and is given
// the newest viewpoint.
std::unique_ptr<LiveFlight> StartLiveFlight(const Caller& caller, v1::RadianceCache::Stub& stub,
                                            const std::string& scene, const LiveOptions& options,
                                            LiveFlight::OnFrame on_frame);

}  // namespace linetree
