#include "control/rt/plan_mailbox.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace hapticd::rt {
namespace {

/// Stands for a program: plain memory that one thread writes before the offer and the other reads
/// after it.
struct Thing {
  explicit Thing(int n) : number(n), check(-n) {}
  ~Thing() { check = 1; }
  int number;
  int check;
  int uses = 0;  // written by the servo side, read by the supervisor after the object came back
};

TEST(PlanMailbox, HandsOneOverAndTheOldOneBack) {
  PlanMailbox<Thing> mailbox;
  Thing first(1), second(2);
  EXPECT_EQ(mailbox.take(), nullptr);
  ASSERT_TRUE(mailbox.offer(&second));
  EXPECT_EQ(mailbox.collect(), nullptr) << "not before the servo thread let go of it";
  EXPECT_EQ(mailbox.take(), &second);
  mailbox.release(&first);
  EXPECT_EQ(mailbox.collect(), &first);
  EXPECT_EQ(mailbox.collect(), nullptr);
}

TEST(PlanMailbox, RefusesASecondOfferUntilTheOldObjectIsCollected) {
  PlanMailbox<Thing> mailbox;
  Thing first(1), second(2), third(3);
  ASSERT_TRUE(mailbox.offer(&second));
  EXPECT_FALSE(mailbox.offer(&third));
  ASSERT_EQ(mailbox.take(), &second);
  mailbox.release(&first);
  EXPECT_FALSE(mailbox.offer(&third)) << "the outbox would be overwritten";
  ASSERT_EQ(mailbox.collect(), &first);
  EXPECT_TRUE(mailbox.offer(&third));
}

TEST(PlanMailbox, AnOfferThatNobodyTookCanBeWithdrawn) {
  PlanMailbox<Thing> mailbox;
  Thing first(1);
  ASSERT_TRUE(mailbox.offer(&first));
  EXPECT_EQ(mailbox.withdraw(), &first);
  EXPECT_EQ(mailbox.withdraw(), nullptr);
  EXPECT_EQ(mailbox.take(), nullptr);
  EXPECT_TRUE(mailbox.offer(&first));
}

TEST(PlanMailboxThreads, EveryObjectIsUsedWholeAndComesBackOnce) {
  constexpr int kSwaps = 5'000;
  PlanMailbox<Thing> mailbox;
  std::atomic<bool> run{true};
  Thing* current = new Thing(0);
  bool broken = false;
  std::thread servo([&] {
    while (run.load(std::memory_order_acquire)) {
      if (Thing* fresh = mailbox.take()) {
        Thing* const old = current;
        current = fresh;
        mailbox.release(old);
      }
      broken = broken || current->check != -current->number;
      ++current->uses;
    }
  });
  int next = 1, returned = 0;
  bool disordered = false;
  auto collect = [&] {
    if (const std::unique_ptr<Thing> old(mailbox.collect()); old) {
      disordered = disordered || old->number != returned;
      ++returned;
    }
  };
  while (next <= kSwaps) {
    auto fresh = std::make_unique<Thing>(next);
    if (mailbox.offer(fresh.get())) {
      (void)fresh.release();
      ++next;
    }
    collect();
    std::this_thread::yield();
  }
  run.store(false, std::memory_order_release);
  servo.join();
  const std::unique_ptr<Thing> left(mailbox.withdraw());
  collect();
  EXPECT_EQ(current->number, returned);
  EXPECT_EQ(returned + (left ? 1 : 0), kSwaps);
  EXPECT_FALSE(broken);
  EXPECT_FALSE(disordered);
  delete current;
}

}  // namespace
}  // namespace hapticd::rt
