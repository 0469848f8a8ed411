// How long a server takes for calls that render nothing while others render: GetStats at equal
// steps, on a thread and a connection of its own.
//
// Latency counts from when a call was to begin, so that a server that stalls shows it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "client/library/client.h"

namespace linetree {

inline constexpr std::chrono::milliseconds kLightCallPeriod{25};

class LightCalls {
 public:
  // Begins. The client must outlive this, and should have no other work.
  LightCalls(Client& client, std::string scene);
  ~LightCalls();
  LightCalls(const LightCalls&) = delete;
  LightCalls& operator=(const LightCalls&) = delete;

  // Ends: latencies in ms, in the order of the calls, at least one. Or the error that ended it.
  absl::StatusOr<std::vector<double>> Finish();

 private:
  void Run();

  Client& client_;
  const std::string scene_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stop_ = false;  // guarded by mutex_
  // The thread's, until it has ended.
  absl::Status error_;
  std::vector<double> latencies_ms_;
  std::thread thread_;
};

}  // namespace linetree
