#include "server/schedule.h"

#include <algorithm>
#include <set>

namespace linetree {
namespace {

// Sessions that wait for nothing, but have had more than others, are remembered up to this many.
constexpr size_t kMaxIdleSessions = 4096;

bool Contains(const std::vector<JobId>& ids, JobId id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

bool Schedule::HasRoomFor(const JobInfo& info, const std::vector<JobId>& displaced) const {
  size_t count = 0;
  uint64_t work = 0;
  for (const auto& [id, job] : jobs_) {
    if (job.has_place || Contains(displaced, id)) continue;
    ++count;
    work += job.work_rays;
  }
  if (count >= limits_.max_waiting) return false;
  return count == 0 ||
         (work <= limits_.max_work_rays && info.work_rays <= limits_.max_work_rays - work);
}

uint64_t Schedule::WaitingWork(Priority priority, const std::string& session,
                               const std::vector<JobId>& displaced) const {
  uint64_t work = 0;
  for (const auto& [id, job] : jobs_) {
    if (job.has_place || job.priority != priority || job.session != session) continue;
    if (!Contains(displaced, id)) work += job.work_rays;
  }
  return work;
}

std::optional<JobId> Schedule::FindVictim(const JobInfo& info,
                                          const std::vector<JobId>& displaced) const {
  std::optional<JobId> victim;
  Priority lowest = info.priority;
  uint64_t most = 0;
  for (const auto& [id, job] : jobs_) {
    if (job.has_place || job.priority < lowest || Contains(displaced, id)) continue;
    const uint64_t work = WaitingWork(job.priority, job.session, displaced);
    if (victim && job.priority == lowest && work < most) continue;
    victim = id;
    lowest = job.priority;
    most = work;
  }
  if (!victim || lowest > info.priority) return victim;
  const uint64_t own = WaitingWork(info.priority, info.session, displaced) + info.work_rays;
  if (most - jobs_.at(*victim).work_rays < own) return std::nullopt;
  return victim;
}

Schedule::Admission Schedule::Add(const JobInfo& info) {
  Admission admission;
  while (!info.has_place && !HasRoomFor(info, admission.displaced)) {
    const auto victim = FindVictim(info, admission.displaced);
    if (!victim) return {};
    admission.displaced.push_back(*victim);
  }
  for (const JobId id : admission.displaced) Remove(id);
  BeginToWait(info);
  admission.job = ++last_id_;
  jobs_[*admission.job] = info;
  return admission;
}

void Schedule::BeginToWait(const JobInfo& info) {
  Class& c = ClassOf(info.priority);
  if (c.turn.waiting++ == 0) c.turn.tag = std::max(c.turn.tag, served_);
  Turn& session = c.sessions[info.session];
  if (session.waiting++ == 0) session.tag = std::max(session.tag, c.served);
}

void Schedule::StopWaiting(const JobInfo& info) {
  Class& c = ClassOf(info.priority);
  --c.turn.waiting;
  --c.sessions[info.session].waiting;
  ForgetIdle(c);
}

void Schedule::ForgetIdle(Class& c) {
  const bool too_many = c.sessions.size() > c.turn.waiting + kMaxIdleSessions;
  std::erase_if(c.sessions, [&](const auto& session) {
    const Turn& turn = session.second;
    return turn.waiting == 0 && (too_many || turn.tag <= c.served);
  });
}

std::optional<Schedule::Candidate> Schedule::FirstOf(Priority priority) {
  Class& c = ClassOf(priority);
  std::optional<Candidate> first;
  std::set<const Turn*> seen;  // a session's own jobs keep their order
  for (auto job = jobs_.begin(); job != jobs_.end(); ++job) {
    if (job->second.priority != priority) continue;
    const Turn& session = c.sessions[job->second.session];
    if (!seen.insert(&session).second) continue;
    const auto work = static_cast<double>(job->second.work_rays);
    if (first && !(session.tag + work < first->session_tag)) continue;
    first = {job, session.tag + work,
             c.turn.tag + work / kPriorityShares[static_cast<size_t>(priority)]};
  }
  return first;
}

std::optional<JobId> Schedule::Next() {
  std::optional<Candidate> next;  // on a tie of the higher class
  for (int i = 0; i < kPriorities; ++i) {
    const auto first = FirstOf(static_cast<Priority>(i));
    if (first && (!next || first->class_tag < next->class_tag)) next = first;
  }
  if (!next) return std::nullopt;
  const auto [id, info] = *next->job;
  Class& c = ClassOf(info.priority);
  served_ = c.turn.tag = next->class_tag;
  c.served = c.sessions[info.session].tag = next->session_tag;
  StopWaiting(info);
  jobs_.erase(next->job);
  return id;
}

std::vector<JobId> Schedule::TakeExpired(JobInfo::Clock::time_point now) {
  std::vector<JobId> expired;
  for (const auto& [id, job] : jobs_) {
    if (job.deadline <= now) expired.push_back(id);
  }
  for (const JobId id : expired) Remove(id);
  return expired;
}

bool Schedule::Remove(JobId job) {
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) return false;
  StopWaiting(found->second);
  jobs_.erase(found);
  return true;
}

JobInfo::Clock::time_point Schedule::EarliestDeadline() const {
  auto earliest = JobInfo::kNever;
  for (const auto& [id, job] : jobs_) earliest = std::min(earliest, job.deadline);
  return earliest;
}

}  // namespace linetree
