// SPDX-License-Identifier: Apache-2.0
// Logs cut off anywhere, changed anywhere, and made to do harm.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>

#include "condyle/hal/log/session_log_reader.h"
#include "support/sanitizer.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::McapRead;
using testing_support::make_header;
using testing_support::make_report;
using testing_support::TemporaryFolder;

#if CONDYLE_UNDER_SANITIZER
constexpr std::uint64_t kCutStep = 13, kFlipStep = 13;  // tens of times slower
#elif defined(__OPTIMIZE__)
constexpr std::uint64_t kCutStep = 1, kFlipStep = 1;
#else
constexpr std::uint64_t kCutStep = 3, kFlipStep = 3;
#endif

// The first `count` reports of a run, then what else a log says.
struct Prefix {
  hal::Status opened = hal::Status::not_open;
  std::size_t count = 0;
  bool is_right = true;  // all that was given, the header included
  hal::SessionLogCondition condition;
};

Prefix read_prefix(const std::string& path, const std::vector<hal::RawReport>& expected) {
  static const hal::SessionHeader header = make_header();
  Prefix prefix;
  hal::SessionLogReader reader;
  prefix.opened = reader.open(path);
  if (prefix.opened == hal::Status::ok) {
    const hal::SessionHeader& read = reader.header();
    prefix.is_right = read.subject_code == header.subject_code &&
                      read.software_version == header.software_version &&
                      read.parameters_toml == header.parameters_toml &&
                      read.start_wall_ns == header.start_wall_ns &&
                      read.start_monotonic_ns == header.start_monotonic_ns &&
                      read.sources[0].name == header.sources[0].name &&
                      read.sources[0].vendor_id == header.sources[0].vendor_id &&
                      read.sources[0].product_id == header.sources[0].product_id &&
                      read.sources[0].profile_toml == header.sources[0].profile_toml &&
                      read.sources[0].report_descriptor == header.sources[0].report_descriptor;
    hal::SessionEntry entry;
    while (reader.next(entry) == McapRead::record) {
      prefix.is_right = prefix.is_right && !entry.is_event && prefix.count < expected.size() &&
                        testing_support::is_same(entry.report, expected[prefix.count]);
      ++prefix.count;
    }
  }
  prefix.condition = reader.condition();
  return prefix;
}

TEST(CutLog, GivesAllChunksBeforeTheCut) {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  std::vector<hal::RawReport> reports;
  struct Milestone {
    std::uint64_t bytes, reports;
  };
  std::vector<Milestone> milestones;  // chunks with their index ended there
  {
    hal::SessionLogWriter log({.chunk_time_ns = 0});
    ASSERT_EQ(log.open(path, make_header()), hal::SessionLogFailure::none);
    milestones.push_back({log.status().bytes_written, 0});
    for (std::uint32_t chunk = 0; chunk < 9; ++chunk) {
      for (std::uint32_t i = 0; i < 16; ++i) {
        const auto number = static_cast<std::uint32_t>(reports.size());
        reports.push_back(make_report(number, static_cast<std::uint16_t>(29 + 66 * i), number));
        ASSERT_TRUE(log.write(0, reports.back()));
      }
      ASSERT_TRUE(testing_support::wait_until_written(log, reports.size()));
      milestones.push_back({log.status().bytes_written, reports.size()});
    }
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  }
  const std::uint64_t size = std::filesystem::file_size(path);
  ASSERT_GT(size, 65'536U + milestones[0].bytes);
  ASSERT_EQ(read_prefix(path, reports).condition.outcome, McapRead::end);
  // From the end, so that one file serves for all.
  for (std::uint64_t cut = size - 1; cut > size - 1 - 65'536; cut -= kCutStep) {
    ASSERT_EQ(truncate(path.c_str(), static_cast<off_t>(cut)), 0);
    const Prefix prefix = read_prefix(path, reports);
    ASSERT_EQ(prefix.opened, hal::Status::ok) << cut;
    ASSERT_TRUE(prefix.is_right) << cut;
    ASSERT_EQ(prefix.condition.outcome, McapRead::truncated) << cut;
    const auto after = std::find_if(milestones.begin(), milestones.end(),
                                    [&](const Milestone& other) { return other.bytes > cut; });
    ASSERT_GE(prefix.count, std::prev(after)->reports) << cut;
    ASSERT_LE(prefix.condition.problem.byte_offset + prefix.condition.lost_bytes, cut);
    if (prefix.count > 0) {
      ASSERT_EQ(prefix.condition.last_report_time_ns, reports[prefix.count - 1].host_time_ns);
    }
  }
}

class SmallLog : public testing::Test {
 protected:
  void SetUp() override {
    for (std::uint32_t i = 0; i < 6; ++i) reports_.push_back(make_report(i, 29, 1000 + i));
    // The writer's thread parts a pair if this one is stalled between its reports.
    std::uint64_t chunks = 0;
    for (int attempt = 0; attempt < 1000 && chunks != 3; ++attempt) {
      ASSERT_NO_FATAL_FAILURE(write_pairs(chunks));
    }
    ASSERT_EQ(chunks, 3U);
    content_ = testing_support::read_file(path_);
  }
  // The log with `change` made to its bytes.
  Prefix read_changed(std::string content) {
    return read_prefix(folder_.write("changed.mcap", content), reports_);
  }

  // The six reports, two in a chunk; `chunks` that they became.
  void write_pairs(std::uint64_t& chunks) {
    std::filesystem::remove(path_);
    hal::SessionLogWriter log({.chunk_time_ns = 0});
    ASSERT_EQ(log.open(path_, make_header()), hal::SessionLogFailure::none);
    header_bytes_ = log.status().bytes_written;
    for (std::size_t i = 0; i < reports_.size(); ++i) {
      ASSERT_TRUE(log.write(0, reports_[i]));
      if (i % 2 == 1) {
        ASSERT_TRUE(testing_support::wait_until_written(log, i + 1));
      }
    }
    chunks = log.status().chunks_written;
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "log.mcap";
  std::vector<hal::RawReport> reports_;
  std::uint64_t header_bytes_ = 0;
  std::string content_;
};

TEST_F(SmallLog, CutWithinItsHeaderIsRefusedClearly) {
  for (std::uint64_t cut = content_.size(); cut-- > 0;) {
    ASSERT_EQ(truncate(path_.c_str(), static_cast<off_t>(cut)), 0);
    const Prefix prefix = read_prefix(path_, reports_);
    ASSERT_TRUE(prefix.is_right);
    ASSERT_EQ(prefix.opened, cut < header_bytes_ ? hal::Status::bad_report : hal::Status::ok);
    ASSERT_NE(prefix.condition.outcome, McapRead::end);
    ASSERT_NE(prefix.condition.problem.reason, "");
    ASSERT_LE(prefix.condition.problem.byte_offset, cut);
  }
}

TEST_F(SmallLog, AnyChangedBitIsNoticed) {
  ASSERT_EQ(read_prefix(path_, reports_).condition.outcome, McapRead::end);
  const int file = open(path_.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(file, 0);
  const auto put = [&](std::uint64_t byte, char value) {
    return pwrite(file, &value, 1, static_cast<off_t>(byte)) == 1;
  };
  for (std::uint64_t bit = 0; bit < 8 * content_.size(); bit += kFlipStep) {
    const char original = content_[bit / 8];
    ASSERT_TRUE(put(bit / 8, static_cast<char>(original ^ (1 << (bit % 8)))));
    const Prefix prefix = read_prefix(path_, reports_);
    ASSERT_TRUE(prefix.is_right) << "bit " << bit;
    const bool is_noticed =
        prefix.opened != hal::Status::ok || prefix.condition.outcome != McapRead::end;
    ASSERT_TRUE(is_noticed) << "bit " << bit;
    ASSERT_NE(prefix.condition.problem.reason, "") << "bit " << bit;
    ASSERT_TRUE(put(bit / 8, original));
  }
  ::close(file);
}

TEST_F(SmallLog, WrongMagicAndVersionAreNamed) {
  std::string other = content_;
  other[5] = '1';
  EXPECT_THAT(read_changed(other).condition.problem.reason, testing::HasSubstr("version"));
  EXPECT_THAT(read_changed("time_s,x_m\n0,1\n").condition.problem.reason,
              testing::HasSubstr("not an MCAP file"));
  EXPECT_THAT(read_changed("").condition.problem.reason, testing::HasSubstr("too short"));
}

TEST_F(SmallLog, ATailOfZerosIsTakenAsACut) {
  const Prefix prefix = read_changed(content_.substr(0, header_bytes_) + std::string(70'000, '\0'));
  EXPECT_EQ(prefix.condition.outcome, McapRead::truncated);
  EXPECT_EQ(prefix.condition.problem.byte_offset, header_bytes_);
  EXPECT_EQ(prefix.condition.lost_bytes, 70'000U);
}

TEST_F(SmallLog, BytesAfterTheEndAreDamage) {
  EXPECT_EQ(read_changed(content_ + "x").condition.outcome, McapRead::damaged);
  EXPECT_EQ(read_changed(content_ + content_).condition.outcome, McapRead::damaged);
}

// Also in a log without an end, where no checksum over all tells.
TEST_F(SmallLog, AMissingChunkIsNoticed) {
  std::vector<std::string> chunks;  // each with its index
  std::size_t at = header_bytes_;
  while (content_[at] == 6 || content_[at] == 7) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      length |= std::uint64_t{static_cast<unsigned char>(content_[at + 1 + i])} << (8 * i);
    }
    if (content_[at] == 6) chunks.emplace_back();
    ASSERT_FALSE(chunks.empty());
    chunks.back() += content_.substr(at, 9 + length);
    at += 9 + length;
  }
  ASSERT_EQ(chunks.size(), 3U);
  const std::string header = content_.substr(0, header_bytes_), end = content_.substr(at);
  EXPECT_EQ(read_changed(header + chunks[0] + chunks[1] + chunks[2] + end).condition.outcome,
            McapRead::end);
  EXPECT_EQ(read_changed(header + chunks[0] + chunks[1] + chunks[2]).condition.outcome,
            McapRead::truncated);
  for (const std::string& tail : {std::string(), end}) {
    const Prefix prefix = read_changed(header + chunks[0] + chunks[2] + tail);
    EXPECT_EQ(prefix.count, 2U);
    EXPECT_TRUE(prefix.is_right);
    EXPECT_EQ(prefix.condition.outcome, McapRead::damaged);
  }
  EXPECT_EQ(read_changed(header + chunks[1] + chunks[2]).condition.outcome, McapRead::damaged);
  EXPECT_EQ(read_changed(header + chunks[0] + chunks[1] + end).condition.outcome,
            McapRead::damaged);
}

}  // namespace
}  // namespace condyle
