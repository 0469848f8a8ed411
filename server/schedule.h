// Which of the jobs that wait goes next, and which find no room: policy only, without threads,
// gRPC or a clock of its own.
//
// The classes of Priority share the work in fixed parts, and within a class its sessions share it
// equally, both by self-clocked fair queueing (Golestani, 1994): each has a tag, the work that it
// has been given, divided by its share. Next goes whose tag would be least with its next job, and
// who comes back after a pause starts from the tag that was served last. So nobody waits for ever,
// whatever others send, and nobody saves up turns by keeping still.
//
// Work is in rays, estimated.
// Thread safety: none.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace linetree {

enum class Priority { kInteractive, kBatch, kBackground };
inline constexpr int kPriorities = 3;
// Of the work, while jobs of all classes wait.
inline constexpr std::array<double, kPriorities> kPriorityShares = {64, 8, 1};

using JobId = uint64_t;

// What is known of a job before it runs.
struct JobInfo {
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::time_point kNever = Clock::time_point::max();

  Priority priority = Priority::kInteractive;
  std::string session = {};  // whose turn it is
  uint64_t work_rays = 1;
  // When nobody wants the result any more.
  Clock::time_point deadline = kNever;
  // Takes no room: the caller bounds how many such jobs there are.
  bool has_place = false;
};

class Schedule {
 public:
  // A waiting job counts, and so does its work; one job alone may be of any size.
  struct Limits {
    size_t max_waiting = 64;
    uint64_t max_work_rays = uint64_t{1} << 31;
  };

  explicit Schedule(const Limits& limits) : limits_(limits) {}

  struct Admission {
    std::optional<JobId> job;      // none: there is no room for it
    std::vector<JobId> displaced;  // by it, and no longer in here
  };
  // Where there is no room, a job takes that of the newest jobs of the session with the most work
  // waiting in the lowest class; in the job's own class only if that session then still has no less
  // waiting than the job's.
  Admission Add(const JobInfo& info);

  // Takes out the job whose turn it is.
  std::optional<JobId> Next();
  // Takes out those whose deadline has come, in the order in which they came in.
  std::vector<JobId> TakeExpired(JobInfo::Clock::time_point now);
  // False when the job is not in here (any more).
  bool Remove(JobId job);

  // kNever when no job has one.
  JobInfo::Clock::time_point EarliestDeadline() const;
  bool empty() const { return jobs_.empty(); }
  size_t size() const { return jobs_.size(); }
  // Of a class.
  size_t size(Priority priority) const {
    return classes_[static_cast<size_t>(priority)].turn.waiting;
  }

 private:
  // The tag of a class or session. It counts while jobs of it wait.
  struct Turn {
    double tag = 0;
    size_t waiting = 0;  // jobs
  };
  struct Class {
    Turn turn;
    double served = 0;  // the tag of the session that was served last, with its job
    std::map<std::string, Turn> sessions;
  };
  using Jobs = std::map<JobId, JobInfo>;  // in the order in which they came
  // A job that may be next, with the tags that it would leave behind.
  struct Candidate {
    Jobs::iterator job;
    double session_tag, class_tag;
  };

  Class& ClassOf(Priority priority) { return classes_[static_cast<size_t>(priority)]; }
  bool HasRoomFor(const JobInfo& info, const std::vector<JobId>& displaced) const;
  // Of jobs that take room and are not displaced.
  uint64_t WaitingWork(Priority priority, const std::string& session,
                       const std::vector<JobId>& displaced) const;
  std::optional<JobId> FindVictim(const JobInfo& info, const std::vector<JobId>& displaced) const;
  std::optional<Candidate> FirstOf(Priority priority);
  void BeginToWait(const JobInfo& info);
  void StopWaiting(const JobInfo& info);
  void ForgetIdle(Class& c);

  const Limits limits_;
  JobId last_id_ = 0;
  double served_ = 0;  // the tag of the class that was served last, with its job
  std::array<Class, kPriorities> classes_;
  Jobs jobs_;
};

}  // namespace linetree
