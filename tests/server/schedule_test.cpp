#include "server/schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace linetree {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

JobInfo Job(const std::string& session, uint64_t work_rays,
            Priority priority = Priority::kInteractive) {
  return {.priority = priority, .session = session, .work_rays = work_rays};
}

JobId Added(Schedule& schedule, const JobInfo& info) {
  const auto admission = schedule.Add(info);
  EXPECT_TRUE(admission.job.has_value());
  return admission.job.value_or(0);
}

std::vector<JobId> TakeAll(Schedule& schedule) {
  std::vector<JobId> order;
  while (const auto id = schedule.Next()) order.push_back(*id);
  return order;
}

TEST(ScheduleTest, OneSessionsJobsGoInTheOrderInWhichTheyCame) {
  Schedule schedule({});
  std::vector<JobId> added;
  for (const uint64_t work : {5, 1, 9, 2}) added.push_back(Added(schedule, Job("a", work)));
  EXPECT_EQ(TakeAll(schedule), added);
  EXPECT_TRUE(schedule.empty());
  EXPECT_EQ(schedule.Next(), std::nullopt);
}

TEST(ScheduleTest, AHigherClassGoesFirst) {
  Schedule schedule({});
  const JobId background = Added(schedule, Job("a", 10, Priority::kBackground));
  const JobId batch = Added(schedule, Job("b", 10, Priority::kBatch));
  const JobId first = Added(schedule, Job("c", 10));
  const JobId second = Added(schedule, Job("d", 10));
  EXPECT_THAT(TakeAll(schedule), ElementsAre(first, second, batch, background));
}

// A session that always has a job waiting; what it has been given.
struct Greedy {
  JobInfo job;
  uint64_t given = 0;
};

// Serves `rounds` jobs, each replaced by another of its session.
void Serve(std::vector<Greedy>& sessions, int rounds) {
  Schedule schedule({});
  std::map<JobId, size_t> owner;
  for (size_t s = 0; s < sessions.size(); ++s) owner[Added(schedule, sessions[s].job)] = s;
  for (int i = 0; i < rounds; ++i) {
    const JobId id = schedule.Next().value();
    Greedy& session = sessions[owner.at(id)];
    session.given += session.job.work_rays;
    owner[Added(schedule, session.job)] = owner.at(id);
  }
}

TEST(ScheduleTest, SessionsGetTheSameWorkWhateverTheirJobsAre) {
  std::vector<Greedy> sessions = {{Job("small", 1)}, {Job("large", 100)}, {Job("odd", 7)}};
  Serve(sessions, 20'000);
  for (const Greedy& session : sessions) {
    // They differ by less than one job of each of two sessions.
    EXPECT_NEAR(static_cast<double>(session.given), static_cast<double>(sessions[0].given), 107)
        << session.job.session;
  }
}

TEST(ScheduleTest, ClassesShareTheWorkAsTheirSharesSayAndNoneStarves) {
  std::vector<Greedy> sessions = {{Job("a", 10, Priority::kInteractive)},
                                  {Job("b", 10, Priority::kBatch)},
                                  {Job("c", 10, Priority::kBackground)}};
  Serve(sessions, 73 * 100);
  for (int i = 0; i < kPriorities; ++i) {
    const auto part = static_cast<size_t>(i);
    EXPECT_NEAR(static_cast<double>(sessions[part].given), 1000 * kPriorityShares[part], 20);
  }
}

TEST(ScheduleTest, ManySessionsOfOneHostDoNotDelayAnotherBeyondItsTurn) {
  Schedule schedule({.max_waiting = 1000});
  for (int i = 0; i < 500; ++i) Added(schedule, Job("crowd", 10));
  const JobId lone = Added(schedule, Job("lone", 10));
  schedule.Next();
  EXPECT_EQ(schedule.Next(), lone);
}

TEST(ScheduleTest, APauseSavesNothingUp) {
  Schedule schedule({});
  for (int i = 0; i < 50; ++i) {  // "b" keeps still meanwhile
    Added(schedule, Job("a", 10));
    schedule.Next();
  }
  std::vector<JobId> of_a;
  for (int i = 0; i < 10; ++i) {
    of_a.push_back(Added(schedule, Job("a", 10)));
    Added(schedule, Job("b", 10));
  }
  const auto order = TakeAll(schedule);
  // After the first turn they alternate.
  const auto of_first_half = std::count_if(order.begin(), order.begin() + 10, [&](JobId id) {
    return std::find(of_a.begin(), of_a.end(), id) != of_a.end();
  });
  EXPECT_NEAR(static_cast<double>(of_first_half), 5, 1);
}

TEST(ScheduleTest, JobsAndTheirWorkAreBounded) {
  Schedule schedule({.max_waiting = 2, .max_work_rays = 100});
  Added(schedule, Job("a", 60));
  EXPECT_EQ(schedule.Add(Job("b", 41)).job, std::nullopt) << "work";
  Added(schedule, Job("b", 40));
  EXPECT_EQ(schedule.Add(Job("c", 1)).job, std::nullopt) << "jobs";
  JobInfo flight = Job("flight", 1'000'000);
  flight.has_place = true;
  Added(schedule, flight);
  EXPECT_EQ(schedule.size(), 3u);
  TakeAll(schedule);
  Added(schedule, Job("a", 1'000'000));  // alone
}

TEST(ScheduleTest, WhoFillsTheQueueMakesRoomForOthers) {
  Schedule schedule({.max_waiting = 4});
  std::vector<JobId> greedy;
  for (int i = 0; i < 4; ++i) greedy.push_back(Added(schedule, Job("greedy", 10)));
  EXPECT_EQ(schedule.Add(Job("greedy", 10)).job, std::nullopt);
  EXPECT_THAT(schedule.Add(Job("b", 10)).displaced, ElementsAre(greedy[3]));
  EXPECT_THAT(schedule.Add(Job("c", 10)).displaced, ElementsAre(greedy[2]));
  // Now nobody has more than the newcomer would have.
  EXPECT_EQ(schedule.Add(Job("b", 10)).job, std::nullopt);
  EXPECT_EQ(schedule.size(), 4u);
}

TEST(ScheduleTest, AHigherClassTakesTheRoomOfLowerOnes) {
  Schedule schedule({.max_waiting = 2});
  const JobId batch = Added(schedule, Job("a", 1, Priority::kBatch));
  const JobId background = Added(schedule, Job("b", 1, Priority::kBackground));
  EXPECT_THAT(schedule.Add(Job("c", 99)).displaced, ElementsAre(background));
  EXPECT_THAT(schedule.Add(Job("c", 1)).displaced, ElementsAre(batch));
  EXPECT_EQ(schedule.Add(Job("d", 1, Priority::kBatch)).job, std::nullopt);
}

TEST(ScheduleTest, ARefusedJobDisplacesNobody) {
  Schedule schedule({.max_waiting = 10, .max_work_rays = 100});
  Added(schedule, Job("a", 50));
  Added(schedule, Job("b", 10, Priority::kBatch));
  EXPECT_EQ(schedule.Add(Job("c", 60)).job, std::nullopt);
  EXPECT_EQ(schedule.size(), 2u);
}

TEST(ScheduleTest, DeadlinesAreTakenOutInTime) {
  Schedule schedule({});
  const JobInfo::Clock::time_point now{};
  EXPECT_EQ(schedule.EarliestDeadline(), JobInfo::kNever);
  const auto with_deadline = [&](int at_s) {
    JobInfo info = Job("a", 1);
    info.deadline = now + seconds(at_s);
    return Added(schedule, info);
  };
  const JobId late = with_deadline(9);
  const JobId soon = with_deadline(3);
  const JobId sooner = with_deadline(2);
  Added(schedule, Job("a", 1));
  EXPECT_EQ(schedule.EarliestDeadline(), now + seconds(2));
  EXPECT_THAT(schedule.TakeExpired(now + seconds(1)), IsEmpty());
  EXPECT_THAT(schedule.TakeExpired(now + seconds(3)), ElementsAre(soon, sooner));
  EXPECT_EQ(schedule.EarliestDeadline(), now + seconds(9));
  EXPECT_TRUE(schedule.Remove(late));
  EXPECT_FALSE(schedule.Remove(late));
  EXPECT_EQ(schedule.EarliestDeadline(), JobInfo::kNever);
  EXPECT_EQ(schedule.size(), 1u);
}

TEST(ScheduleTest, EveryJobLeavesOnce) {
  std::mt19937 random(5);
  Schedule schedule({.max_waiting = 20, .max_work_rays = 500});
  std::set<JobId> inside;
  for (int i = 0; i < 20'000; ++i) {
    if (random() % 3 != 0) {
      JobInfo info = Job(std::string(1, static_cast<char>('a' + random() % 9)), 1 + random() % 90,
                         static_cast<Priority>(random() % kPriorities));
      info.has_place = random() % 8 == 0;
      const auto admission = schedule.Add(info);
      for (const JobId id : admission.displaced) EXPECT_EQ(inside.erase(id), 1u);
      if (admission.job) {
        EXPECT_TRUE(inside.insert(*admission.job).second);
      }
    } else if (random() % 4 == 0 && !inside.empty()) {
      EXPECT_TRUE(schedule.Remove(*inside.begin()));
      inside.erase(inside.begin());
    } else if (const auto id = schedule.Next()) {
      EXPECT_EQ(inside.erase(*id), 1u);
    }
    ASSERT_EQ(schedule.size(), inside.size());
  }
  for (const JobId id : TakeAll(schedule)) EXPECT_EQ(inside.erase(id), 1u);
  EXPECT_TRUE(inside.empty());
}

}  // namespace
}  // namespace linetree
