// SPDX-License-Identifier: Apache-2.0
// What is recorded comes back, bit for bit; what cannot be recorded is refused or counted.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <limits>

#include "support/rapidcheck_gtest.h"
#include "support/read_log.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::SessionEvent;
using hal::SessionLogFailure;
using testing_support::make_header;
using testing_support::make_report;
using testing_support::read_log;
using testing_support::TemporaryFolder;

TEST(SubjectCode, IsAPseudonymOfPlainLetters) {
  for (const char* good : {"", "S07", "s-07_B", "0", "ABCDEFGHIJKLMNOPQRSTUVWXYZ012345"}) {
    EXPECT_TRUE(hal::is_subject_code(good)) << good;
  }
  for (const char* bad : {"Jane Doe", "a.b", "a/b", "\xc3\xa4", "a\n", " ", "a@b",
                          "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456"}) {
    EXPECT_FALSE(hal::is_subject_code(bad)) << bad;
  }
}

TEST(SessionLog, RefusesAHeaderThatItCannotKeep) {
  const TemporaryFolder folder;
  const auto refuse = [&](auto change) {
    hal::SessionHeader header = make_header();
    change(header);
    EXPECT_NE(hal::header_problem(header), "");
    hal::SessionLogWriter log;
    EXPECT_EQ(log.open(folder / "log.mcap", header), SessionLogFailure::bad_header);
  };
  refuse([](auto& header) { header.subject_code = "Jane Doe"; });
  refuse([](auto& header) { header.software_version.clear(); });
  refuse([](auto& header) { header.software_version.assign(65, '1'); });
  refuse([](auto& header) { header.sources.clear(); });
  refuse([](auto& header) { header.sources.resize(9, header.sources[0]); });
  refuse([](auto& header) { header.sources[0].name = "the facebow"; });
  refuse([](auto& header) { header.sources[0].profile_toml.assign((1U << 20U) + 1, 'x'); });
  refuse([](auto& header) { header.sources[0].report_descriptor.resize(4097); });
  refuse([](auto& header) { header.parameters_toml.assign((1U << 20U) + 1, 'x'); });
  refuse([](auto& header) { header.begun_with_json.assign((1U << 20U) + 1, 'x'); });
  refuse([](auto& header) { header.start_wall_ns = -1; });
  EXPECT_EQ(folder.count(), 0);
}

// Also a chunk of as many events as reports. The wait is for a hang only.
TEST(SessionLog, WritesAChunkAtItsTime) {
  const TemporaryFolder folder;
  hal::SessionLogWriter log({.chunk_time_ns = 1'000'000'000});
  ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  ASSERT_TRUE(log.write(0, make_report(0, 29, 1)));
  ASSERT_TRUE(log.write_event(0, 1, SessionEvent::note, "beside a report"));
  for (int i = 0; log.status().events_written == 0 && i < 6000; ++i) usleep(10'000);
  EXPECT_EQ(log.status().reports_written, 1U);
  EXPECT_EQ(log.status().events_written, 1U);
  EXPECT_EQ(log.close(), SessionLogFailure::none);
}

TEST(SessionLog, IsReadableByItsOwnerAlone) {
  const TemporaryFolder folder;
  const mode_t before = umask(0);
  hal::SessionLogWriter log;
  EXPECT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  umask(before);
  struct stat information {};
  ASSERT_EQ(stat((folder / "log.mcap").c_str(), &information), 0);
  EXPECT_EQ(information.st_mode & 07777U, 0600U);
  EXPECT_EQ(log.close(), SessionLogFailure::none);
}

TEST(SessionLog, OverwritesNothing) {
  const TemporaryFolder folder;
  const std::string path = folder.write("log.mcap", "precious");
  std::filesystem::create_symlink(folder / "elsewhere", folder / "link.mcap");
  hal::SessionLogWriter log;
  EXPECT_EQ(log.open(path, make_header()), SessionLogFailure::already_exists);
  EXPECT_EQ(testing_support::read_file(path), "precious");
  hal::SessionLogWriter through_link;
  EXPECT_EQ(through_link.open(folder / "link.mcap", make_header()),
            SessionLogFailure::already_exists);
  EXPECT_FALSE(std::filesystem::exists(folder / "elsewhere"));
  hal::SessionLogWriter nowhere;
  EXPECT_EQ(nowhere.open(folder / "no/log.mcap", make_header()), SessionLogFailure::not_found);
}

TEST(SessionLog, NamesNoMachineAndNoUser) {
  const TemporaryFolder folder;
  {
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  }
  const std::string content = testing_support::read_file(folder / "log.mcap");
  char host[256] = {};
  ASSERT_EQ(gethostname(host, sizeof(host) - 1), 0);
  if (std::string(host).size() > 3 &&
      std::string("condyle device").find(host) == std::string::npos) {
    EXPECT_THAT(content, testing::Not(testing::HasSubstr(host)));
  }
  EXPECT_THAT(content, testing::Not(testing::HasSubstr(folder.path().string())));
  EXPECT_THAT(content, testing::HasSubstr("S-07_b"));
}

TEST(SessionLog, WithoutReportsIsComplete) {
  const TemporaryFolder folder;
  {
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(folder / "log.mcap", make_header(2)), SessionLogFailure::none);
  }
  const auto read = read_log(folder / "log.mcap");
  EXPECT_EQ(read.opened, hal::Status::ok);
  EXPECT_EQ(read.condition.outcome, hal::McapRead::end);
  testing_support::expect_same(read.header, make_header(2));
  EXPECT_FALSE(read.condition.last_report_time_ns.has_value());
}

// Any header, any reports with any times, any texts; from several sources.
RC_GTEST_PROP(SessionLogProperty, GivesBackWhatWasWritten, ()) {
  const TemporaryFolder folder;
  const auto text = [] { return rc::gen::string<std::string>(); };
  hal::SessionHeader header = make_header(*rc::gen::inRange<std::size_t>(1, 9));
  header.parameters_toml = *text();
  header.begun_with_json = *text();
  header.start_monotonic_ns = *rc::gen::arbitrary<TimeNs>();
  header.start_wall_ns = *rc::gen::suchThat<TimeNs>([](TimeNs time_ns) { return time_ns >= 0; });
  for (hal::SessionSource& source : header.sources) {
    source.profile_toml = *text();
    source.report_descriptor = *rc::gen::arbitrary<std::vector<std::uint8_t>>();
    source.vendor_id = *rc::gen::arbitrary<std::uint16_t>();
  }
  std::vector<std::vector<hal::RawReport>> reports(header.sources.size());
  struct Event {
    std::size_t source_index, reports_before;
    TimeNs time_ns;
    SessionEvent kind;
    std::string text;
  };
  std::vector<Event> events;
  hal::SessionLogWriter log({.chunk_time_ns = *rc::gen::element<TimeNs>(0, 200'000'000)});
  RC_ASSERT(log.open(folder / "log.mcap", header) == SessionLogFailure::none);
  const auto count = *rc::gen::inRange<std::uint32_t>(0, 300);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto source = *rc::gen::inRange<std::size_t>(0, header.sources.size());
    const auto time_ns = *rc::gen::arbitrary<TimeNs>();
    if (*rc::gen::inRange(0, 5) == 0) {
      const auto kind = static_cast<SessionEvent>(*rc::gen::inRange(1, 8));
      events.push_back({source, reports[source].size(), time_ns, kind, *text()});
      RC_ASSERT(log.write_event(source, time_ns, kind, events.back().text));
    } else {
      const auto size = *rc::gen::inRange<std::uint16_t>(0, hal::kMaxReportSize + 1);
      reports[source].push_back(make_report(i, size, time_ns));
      RC_ASSERT(log.write(source, reports[source].back()));
    }
  }
  RC_ASSERT(log.close() == SessionLogFailure::none);
  RC_ASSERT(log.status().reports_lost == 0U);
  RC_ASSERT(log.status().events_written == events.size());

  const auto read = read_log(folder / "log.mcap");
  RC_ASSERT(read.opened == hal::Status::ok);
  RC_ASSERT(read.condition.outcome == hal::McapRead::end);
  RC_ASSERT(read.header.parameters_toml == header.parameters_toml);
  RC_ASSERT(read.header.begun_with_json == header.begun_with_json);
  RC_ASSERT(read.header.start_monotonic_ns == header.start_monotonic_ns);
  for (std::size_t s = 0; s < header.sources.size(); ++s) {
    RC_ASSERT(read.header.sources[s].profile_toml == header.sources[s].profile_toml);
    RC_ASSERT(read.header.sources[s].report_descriptor == header.sources[s].report_descriptor);
    RC_ASSERT(read.header.sources[s].vendor_id == header.sources[s].vendor_id);
    RC_ASSERT(read.reports[s].size() == reports[s].size());
    for (std::size_t i = 0; i < reports[s].size(); ++i) {
      RC_ASSERT(testing_support::is_same(read.reports[s][i], reports[s][i]));
    }
    // A source's events stand where they happened among its reports.
    std::vector<Event> of_source;
    for (const Event& event : events) {
      if (event.source_index == s) of_source.push_back(event);
    }
    std::size_t next = 0;
    for (const auto& event : read.events) {
      if (event.source_index != s) continue;
      RC_ASSERT(next < of_source.size());
      const Event& expected = of_source[next++];
      RC_ASSERT(event.reports_before == expected.reports_before);
      RC_ASSERT(event.event.time_ns == expected.time_ns);
      RC_ASSERT(event.event.kind == expected.kind);
      RC_ASSERT(event.text == expected.text);
    }
    RC_ASSERT(next == of_source.size());
  }
}

TEST(SessionLog, ALongTextIsCutVisibly) {
  const TemporaryFolder folder;
  {
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
    EXPECT_TRUE(log.write_event(0, 1, SessionEvent::note, std::string(600, 'a')));
  }
  const auto read = read_log(folder / "log.mcap");
  ASSERT_EQ(read.events.size(), 1U);
  EXPECT_EQ(read.events[0].text, std::string(509, 'a') + "...");
}

// A small ring and reports faster than any writer: whatever is lost is counted, and the log says so
// between the reports where it happened.
TEST(SessionLog, AFullRingIsCountedAndRecorded) {
  const TemporaryFolder folder;
  constexpr std::uint32_t kReports = 20'000;
  hal::SessionLogWriter log({.ring_reports = 16, .chunk_time_ns = 0});
  ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  std::uint64_t refused = 0;
  for (std::uint32_t i = 0; i < kReports; ++i) {
    if (!log.write(0, make_report(i, 29, i))) ++refused;
    // Now and then room comes, so that losses lie between reports, too.
    if (i % 5'000 == 4'999) {
      ASSERT_TRUE(testing_support::wait_until_written(log, i + 1 - refused));
    }
  }
  // Places are kept for events.
  while (log.write(0, make_report(kReports, 29, kReports))) {
  }
  ++refused;
  EXPECT_TRUE(log.write_event(0, 5, SessionEvent::disconnected, "unplugged"));
  EXPECT_EQ(log.close(), SessionLogFailure::none);
  const auto status = log.status();
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(status.reports_lost, refused);
  EXPECT_EQ(status.events_written, 1U);

  const auto read = read_log(folder / "log.mcap");
  EXPECT_EQ(read.condition.outcome, hal::McapRead::end);
  EXPECT_EQ(read.reports[0].size(), status.reports_written);
  std::uint64_t said = 0;
  for (const auto& event : read.events) {
    if (event.event.kind != SessionEvent::not_recorded) continue;
    said += event.event.count;
    if (event.reports_before == 0 || event.reports_before >= read.reports[0].size()) continue;
    // Exactly that many are missing there.
    const auto number = [&](std::size_t i) { return read.reports[0][i].host_time_ns; };
    EXPECT_EQ(number(event.reports_before) - number(event.reports_before - 1) - 1,
              static_cast<TimeNs>(event.event.count));
  }
  EXPECT_EQ(said, refused);
}

TEST(SessionLog, CountsWhatComesWhileItIsNotOpen) {
  const TemporaryFolder folder;
  hal::SessionLogWriter log;
  EXPECT_FALSE(log.write(0, make_report(0, 29, 0)));
  ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  EXPECT_FALSE(log.write(1, make_report(0, 29, 0)));
  EXPECT_FALSE(log.write_event(1, 0, SessionEvent::note, ""));
  hal::RawReport impossible;
  impossible.size = hal::kMaxReportSize + 1;
  EXPECT_FALSE(log.write(0, impossible));
  EXPECT_EQ(log.close(), SessionLogFailure::none);
  EXPECT_FALSE(log.write(0, make_report(0, 29, 0)));
  EXPECT_EQ(log.close(), SessionLogFailure::none);
  EXPECT_EQ(log.status().reports_lost, 4U);
  EXPECT_EQ(log.status().events_lost, 1U);
}

// The largest file the process may write, for as long as this lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(SessionLog, AFullDiskIsSaidAndLeavesAReadableLog) {
  const TemporaryFolder folder;
  constexpr std::uint32_t kReports = 3'000;
  hal::SessionLogWriter log({.chunk_time_ns = 0});
  std::uint64_t refused = 0;
  {
    const FileSizeLimit limit(200'000);
    ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
    for (std::uint32_t i = 0; i < kReports; ++i) {
      if (!log.write(0, make_report(i, 500, i))) ++refused;
      if (i == 50) {
        ASSERT_TRUE(testing_support::wait_until_written(log, 51));
      }
    }
    EXPECT_EQ(log.close(), SessionLogFailure::disk_full);
  }
  const auto status = log.status();
  EXPECT_EQ(status.failure, SessionLogFailure::disk_full);
  EXPECT_EQ(status.system_error, EFBIG);
  EXPECT_GT(status.reports_written, 0U);
  EXPECT_GT(status.reports_lost, 0U);
  EXPECT_EQ(status.reports_written + status.reports_lost, kReports);
  EXPECT_EQ(refused, 0U);

  const auto read = read_log(folder / "log.mcap");
  EXPECT_EQ(read.condition.outcome, hal::McapRead::truncated);
  ASSERT_EQ(read.reports[0].size(), status.reports_written);
  for (std::uint32_t i = 0; i < read.reports[0].size(); ++i) {
    ASSERT_TRUE(testing_support::is_same(read.reports[0][i], make_report(i, 500, i)));
  }
}

TEST(SessionLog, ADiskFullFromTheStartLeavesNothingBehind) {
  const TemporaryFolder folder;
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  {
    const FileSizeLimit limit(100);
    hal::SessionLogWriter log;
    EXPECT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::disk_full);
    EXPECT_FALSE(log.write(0, make_report(0, 29, 0)));
    // A file opened now has the number that the log's had; closing the log leaves it open.
    const int other = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    EXPECT_EQ(log.close(), SessionLogFailure::disk_full);
    EXPECT_EQ(::close(other), 0);
  }
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(folder.count(), 0);
}

// Recording a facebow at 500 Hz for ten seconds, a chunk each 200 ms.
TEST(SessionLog, TakesFewBytesAReport) {
  const TemporaryFolder folder;
  constexpr std::uint32_t kReports = 5'000, kInAChunk = 100;
  hal::SessionLogWriter log({.chunk_time_ns = 0});
  ASSERT_EQ(log.open(folder / "log.mcap", make_header()), SessionLogFailure::none);
  std::mt19937 random(1);
  for (std::uint32_t i = 0; i < kReports; ++i) {
    // As a facebow's: counter, microseconds, nine smooth coordinates with noise, checksum.
    hal::RawReport report;
    report.host_time_ns =
        5'000'000'000 + TimeNs{i} * 2'000'000 + static_cast<TimeNs>(random() % 200'000);
    report.size = 29;
    report.bytes[0] = 1;
    const auto put = [&](std::size_t at, std::uint64_t value, int size) {
      for (int byte = 0; byte < size; ++byte) {
        report.bytes[at++] = static_cast<std::uint8_t>(value >> (8 * byte));
      }
    };
    put(1, i, 4);
    put(5, i * 2'000U, 4);
    for (std::size_t axis = 0; axis < 9; ++axis) {
      const double position = 5000 * std::sin(0.004 * i + static_cast<double>(axis));
      put(9 + 2 * axis,
          static_cast<std::uint64_t>(static_cast<std::int64_t>(position)) + random() % 5, 2);
    }
    put(27, random(), 2);
    ASSERT_TRUE(log.write(0, report));
    if (i % kInAChunk == kInAChunk - 1) {
      ASSERT_TRUE(testing_support::wait_until_written(log, i + 1));
    }
  }
  EXPECT_EQ(log.close(), SessionLogFailure::none);
  const auto status = log.status();
  const double bytes_a_report = static_cast<double>(status.bytes_written) / kReports;
  RecordProperty("bytes_a_report", std::to_string(bytes_a_report));
  std::printf("%.1f bytes a report, %llu chunks\n", bytes_a_report,
              static_cast<unsigned long long>(status.chunks_written));
  EXPECT_LT(bytes_a_report, 29 + 45);
}

}  // namespace
}  // namespace condyle
