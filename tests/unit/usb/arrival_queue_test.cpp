#include "drivers/usb/arrival_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/hid/superseding.h"

namespace hapticd::test {
namespace {

using usb::ArrivalQueue;
using usb::Status;
using ArrivalBytes = std::vector<std::uint8_t>;

ArrivalBytes next(ArrivalQueue& queue) {
  const usb::Arrival arrival = queue.take();
  return {arrival.bytes.begin(), arrival.bytes.end()};
}

TEST(ArrivalQueue, HandsOutInOrderWithTheStampOfEach) {
  ArrivalQueue queue(8, {});
  EXPECT_EQ(queue.take().status, Status::nothing);
  queue.push(ArrivalBytes{1, 2}, 10);
  queue.push(ArrivalBytes{3}, 20);
  const usb::Arrival first = queue.take();
  EXPECT_EQ(first.status, Status::ok);
  EXPECT_EQ(first.stamp_ns, 10);
  EXPECT_THAT(first.bytes, testing::ElementsAre(1, 2));
  EXPECT_EQ(queue.take().stamp_ns, 20);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.skipped(), 0U);
}

TEST(ArrivalQueue, WhatWasHandedOutStandsUntilTheNextTake) {
  ArrivalQueue queue(8, {});
  queue.push(ArrivalBytes{1, 2}, 1);
  const usb::Arrival first = queue.take();
  for (std::uint8_t i = 0; i < 200; ++i) queue.push(ArrivalBytes{9, i}, 2);
  EXPECT_THAT(first.bytes, testing::ElementsAre(1, 2));
}

TEST(ArrivalQueue, FullItLosesTheOldestAndCountsIt) {
  ArrivalQueue queue(8, {});
  for (std::uint8_t i = 0; i < ArrivalQueue::kMost + 3; ++i) queue.push(ArrivalBytes{i}, i);
  EXPECT_EQ(queue.skipped(), 3U);
  for (std::uint8_t i = 3; i < ArrivalQueue::kMost + 3; ++i)
    EXPECT_EQ(next(queue), ArrivalBytes{i});
  EXPECT_TRUE(queue.empty());
}

TEST(ArrivalQueue, WithoutIdsTheNewestTakesThePlaceOfAll) {
  ArrivalQueue queue(8, {.newest_only = true});
  for (std::uint8_t i = 1; i <= 5; ++i) queue.push(ArrivalBytes{i, 7}, i);
  EXPECT_EQ(next(queue), (ArrivalBytes{5, 7}));
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.skipped(), 4U);
}

TEST(ArrivalQueue, OfPositionsTheNewestStaysAndOfOtherIdsAll) {
  ArrivalQueue queue(8, {.newest_only = true, .numbered = true, .only_of_id = 1});
  queue.push(ArrivalBytes{1, 1}, 1);
  queue.push(ArrivalBytes{0xa1, 1}, 2);
  queue.push(ArrivalBytes{2, 1}, 3);
  queue.push(ArrivalBytes{1, 2}, 4);
  queue.push(ArrivalBytes{0xa1, 2}, 5);
  queue.push(ArrivalBytes{2, 2}, 6);
  EXPECT_EQ(next(queue), (ArrivalBytes{1, 2})) << "in the place of the one that it replaces";
  EXPECT_EQ(next(queue), (ArrivalBytes{0xa1, 1}));
  EXPECT_EQ(next(queue), (ArrivalBytes{2, 1}));
  EXPECT_EQ(next(queue), (ArrivalBytes{0xa1, 2}));
  EXPECT_EQ(next(queue), (ArrivalBytes{2, 2})) << "a state is no position";
  EXPECT_EQ(queue.skipped(), 1U);
}

TEST(ArrivalQueue, TooMuchIsCutAndNothingIsNoArrival) {
  ArrivalQueue queue(2, {});
  queue.push(ArrivalBytes{}, 1);
  EXPECT_TRUE(queue.empty());
  queue.push(ArrivalBytes{1, 2, 3}, 1);
  EXPECT_EQ(next(queue), (ArrivalBytes{1, 2}));
}

hid::ReportDescriptor descriptor_with(std::uint8_t id, std::uint32_t in_bytes,
                                      std::uint32_t out_bytes) {
  hid::ReportDescriptor descriptor{.numbered = true};
  descriptor.report_bits[0][id] = 8 * in_bytes;
  descriptor.report_bits[1][id] = 8 * out_bytes;
  return descriptor;
}

TEST(Superseding, AnOpenFfboardIsKnownByItsCommandChannel) {
  EXPECT_EQ(hid::superseding_of(descriptor_with(0xa1, 25, 25)).only_of_id, 1);
  EXPECT_FALSE(hid::superseding_of(descriptor_with(0xa1, 24, 25)).only_of_id);
  EXPECT_FALSE(hid::superseding_of(descriptor_with(0xa1, 25, 0)).only_of_id);
  EXPECT_FALSE(hid::superseding_of(descriptor_with(0xa2, 25, 25)).only_of_id);
  EXPECT_TRUE(hid::superseding_of(descriptor_with(1, 8, 8)).newest_only);
}

}  // namespace
}  // namespace hapticd::test
