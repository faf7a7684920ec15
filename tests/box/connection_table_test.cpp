// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/connection_table.h"

#include <gmock/gmock.h>

namespace condyle::box {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ConnectionTable, ClosesTheOldestIdleOneOfAnAddress) {
  ConnectionTable table(3, 1000);
  std::vector<int> ending;
  auto* const first = table.opened("a", 1, 0, ending);
  (void)table.opened("b", 2, 0, ending);
  auto* const second = table.opened("a", 3, 0, ending);
  (void)table.opened("a", 4, 0, ending);
  first->is_idle = false;
  EXPECT_THAT(ending, IsEmpty());
  (void)table.opened("a", 5, 0, ending);
  EXPECT_THAT(ending, ElementsAre(3));
  // One that was told to end counts no more, before it has ended or after.
  table.closed(second);
  (void)table.opened("a", 6, 0, ending);
  EXPECT_THAT(ending, ElementsAre(3, 4));
  EXPECT_EQ(table.size(), 5U);
}

TEST(ConnectionTable, ClosesTheNewOneWhereNoneIsIdle) {
  ConnectionTable table(2, 1000);
  std::vector<int> ending;
  for (int i = 1; i <= 2; ++i) table.opened("a", i, 0, ending)->is_idle = false;
  (void)table.opened("a", 3, 0, ending);
  EXPECT_THAT(ending, ElementsAre(3));
}

TEST(ConnectionTable, TellsEachThatIsLateOnce) {
  ConnectionTable table(9, 1000);
  std::vector<int> ending;
  auto* const answered = table.opened("a", 1, 0, ending);
  (void)table.opened("a", 2, 100, ending);
  (void)table.opened("a", 3, 500, ending);
  answered->is_idle = false;
  table.collect_late(1099, ending);
  EXPECT_THAT(ending, IsEmpty());
  table.collect_late(1100, ending);
  table.collect_late(1200, ending);
  EXPECT_THAT(ending, ElementsAre(2));
  answered->is_idle = true;
  answered->since_ns = 1200;
  table.collect_late(1500, ending);
  EXPECT_THAT(ending, ElementsAre(2, 3));
}

}  // namespace
}  // namespace condyle::box
