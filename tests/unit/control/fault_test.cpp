#include "control/core/fault.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace hapticd {
namespace {

TEST(FaultTable, EveryCodeHasItsRowAndAnAction) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < fault_table().size(); ++i) {
    const FaultEntry& row = fault_table()[i];
    EXPECT_EQ(static_cast<std::size_t>(row.code), i) << row.name;
    EXPECT_TRUE(names.insert(std::string(row.name)).second) << row.name << " stands twice";
    EXPECT_FALSE(row.meaning.empty());
    if (row.code == Fault::none) continue;
    EXPECT_FALSE(row.action.empty()) << row.name << ": what should the operator do?";
    EXPECT_FALSE(row.set_by.empty()) << row.name;
  }
}

TEST(FaultTable, EveryLimitIsOneBitWithARow) {
  std::uint32_t seen = 0;
  for (const LimitEntry& row : limit_table()) {
    const auto bit = static_cast<std::uint32_t>(row.bit);
    EXPECT_EQ(bit & (bit - 1), 0u);
    EXPECT_EQ(seen & bit, 0u) << row.name;
    seen |= bit;
    EXPECT_FALSE(row.action.empty());
  }
}

TEST(FaultTable, UnknownCodeReadsAsNone) {
  EXPECT_EQ(entry(static_cast<Fault>(200)).code, Fault::none);
}

}  // namespace
}  // namespace hapticd
