// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/number_text.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "support/rapidcheck_gtest.h"

namespace condyle::host {
namespace {

RC_GTEST_PROP(NumberText, WrittenNumbersReadBackExactly, ()) {
  const auto bits = *rc::gen::arbitrary<std::uint64_t>();
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  std::string text;
  append_number(text, value);
  double read = 0;
  if (std::isfinite(value)) {
    RC_ASSERT(parse_number(text, read) == NumberStatus::ok);
    RC_ASSERT(std::memcmp(&read, &value, sizeof value) == 0);
  } else {
    RC_ASSERT(text.empty());
  }
}

RC_GTEST_PROP(NumberText, TimesReadBackToTheNanosecond, ()) {
  const auto time_ns =
      *rc::gen::inRange<TimeNs>(-4'600'000'000'000'000'000, 4'600'000'000'000'000'000);
  std::string text;
  append_time_s(text, time_ns);
  TimeNs read = 0;
  RC_ASSERT(parse_time_s(text, read) == NumberStatus::ok);
  RC_ASSERT(read == time_ns);
}

TEST(NumberText, TimesRoundBeyondNinePlaces) {
  TimeNs time_ns = 0;
  const auto read = [&](const char* text) {
    return parse_time_s(text, time_ns) == NumberStatus::ok ? time_ns : -1;
  };
  EXPECT_EQ(read("0.0166666667"), 16'666'667);
  EXPECT_EQ(read("0.01666666649"), 16'666'666);
  EXPECT_EQ(read("1700000000.123456789"), 1'700'000'000'123'456'789);
  EXPECT_EQ(read("-0.5"), -500'000'000);
  EXPECT_EQ(read("+.5"), 500'000'000);
  EXPECT_EQ(read("1.5e-3"), 1'500'000);
  EXPECT_EQ(read("12345678901234567890e-10"), 1'234'567'890'123'456'768) << "through a double";
  EXPECT_EQ(read(" 2\t"), 2'000'000'000);
  EXPECT_EQ(parse_time_s("4.7e9", time_ns), NumberStatus::overflow);
  EXPECT_EQ(parse_time_s("nan", time_ns), NumberStatus::not_finite);
}

TEST(NumberText, TellsTheKindsOfBadNumbersApart) {
  double value = 0;
  for (const char* text : {"", " ", "\t"})
    EXPECT_EQ(parse_number(text, value), NumberStatus::empty);
  for (const char* text :
       {"abc", "1.2.3", "1,5", "0x10", "1e", "-", "+", "+-1", "1 2", "NA", "--1"}) {
    EXPECT_EQ(parse_number(text, value), NumberStatus::not_a_number) << text;
  }
  for (const char* text : {"nan", "NaN", "-nan", "inf", "-Infinity", "+inf"}) {
    EXPECT_EQ(parse_number(text, value), NumberStatus::not_finite) << text;
  }
  for (const char* text : {"1e999", "-1e309"}) {
    EXPECT_EQ(parse_number(text, value), NumberStatus::overflow) << text;
  }
  EXPECT_EQ(parse_number("1e-999", value), NumberStatus::ok);
  EXPECT_EQ(value, 0);
  EXPECT_EQ(parse_number("+1.5", value), NumberStatus::ok);
  EXPECT_EQ(value, 1.5);
}

TEST(NumberText, QuotesForMessages) {
  EXPECT_EQ(quote("ab\x01\xff"), "'ab\\x01\\xff'");
  EXPECT_EQ(quote(std::string(100, 'x')), "'" + std::string(40, 'x') + "...'");
}

}  // namespace
}  // namespace condyle::host
