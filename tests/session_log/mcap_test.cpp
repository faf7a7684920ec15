// SPDX-License-Identifier: Apache-2.0
// The MCAP container itself: our writer, our reader, and files others write.
#include <gmock/gmock.h>
#include <zstd.h>

#include <cstdint>
#include <string>

#include "condyle/hal/log/mcap_reader.h"
#include "condyle/hal/log/mcap_writer.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::McapRead;
using hal::Status;
using testing_support::TemporaryFolder;

template <typename Number>
std::string number(Number value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  return bytes;
}
std::string text(const std::string& value) {
  return number(static_cast<std::uint32_t>(value.size())) + value;
}
std::string record(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + number<std::uint64_t>(content.size()) + content;
}
const std::string kMagic = "\x89MCAP0\r\n";
const std::string kHeader = record(1, text("") + text("test"));
const std::string kChannel = record(4, number<std::uint16_t>(1) + number<std::uint16_t>(0) +
                                           text("/t") + text("json") + number<std::uint32_t>(0));
const std::string kMessage =
    record(5, number<std::uint16_t>(1) + number<std::uint32_t>(0) + number<std::uint64_t>(7) +
                  number<std::uint64_t>(7) + "{}");
const std::string kFooter =
    record(2, number<std::uint64_t>(0) + number<std::uint64_t>(0) + number<std::uint32_t>(0));

std::string chunk(const std::string& compression, const std::string& records, std::uint64_t size,
                  std::uint32_t crc = 0) {
  return record(6, number<std::uint64_t>(7) + number<std::uint64_t>(7) + number(size) +
                       number(crc) + text(compression) + number<std::uint64_t>(records.size()) +
                       records);
}

class Mcap : public testing::Test {
 protected:
  // Outcome after all records; messages are counted.
  McapRead read(const std::string& content, hal::McapLimits limits = {}) {
    hal::McapReader reader(limits);
    messages_ = 0;
    const Status status = reader.open(folder_.write("file.mcap", content));
    reason_ = reader.problem().reason;
    if (status != Status::ok) return McapRead::damaged;
    hal::McapRecord found;
    McapRead outcome = McapRead::record;
    while ((outcome = reader.next(found)) == McapRead::record) {
      messages_ += std::holds_alternative<hal::McapMessage>(found) ? 1 : 0;
    }
    EXPECT_EQ(reader.next(found), outcome);
    reason_ = reader.problem().reason;
    return outcome;
  }

  TemporaryFolder folder_;
  int messages_ = 0;
  std::string reason_;
};

TEST_F(Mcap, ReadsTheSmallestFiles) {
  EXPECT_EQ(read(kMagic + kHeader + kFooter + kMagic), McapRead::end) << reason_;
  EXPECT_EQ(read(kMagic + kHeader + kChannel + kMessage + kFooter + kMagic), McapRead::end);
  EXPECT_EQ(messages_, 1);
  const std::string inside = kChannel + kMessage;
  EXPECT_EQ(read(kMagic + kHeader + chunk("", inside, inside.size()) +
                 record(15, number<std::uint32_t>(0)) + kFooter + kMagic),
            McapRead::end)
      << reason_;
  EXPECT_EQ(messages_, 1);
}

TEST_F(Mcap, SkipsOthersExtensionsUnlessStrict) {
  const std::string file =
      kMagic + kHeader + record(0x91, "private") + kChannel + kMessage + kFooter + kMagic;
  EXPECT_EQ(read(file), McapRead::end);
  EXPECT_EQ(messages_, 1);
  EXPECT_EQ(read(file, {.is_strict = true}), McapRead::damaged);
}

TEST_F(Mcap, RefusesMoreThanItsLimits) {
  // A megabyte of zeros in a few bytes, truly declared and falsely.
  const std::string zeros(std::size_t{1} << 20, '\0');
  std::string bomb(ZSTD_compressBound(zeros.size()), '\0');
  bomb.resize(ZSTD_compress(bomb.data(), bomb.size(), zeros.data(), zeros.size(), 3));
  ASSERT_LT(bomb.size(), 1000U);
  const hal::McapLimits limits{.record_bytes = 4096, .chunk_bytes = 65'536};
  const std::string start = kMagic + kHeader, end = kFooter + kMagic;
  for (const std::uint64_t declared : {std::uint64_t{zeros.size()}, std::uint64_t{65'537},
                                       ~std::uint64_t{0}, std::uint64_t{1} << 63}) {
    EXPECT_EQ(read(start + chunk("zstd", bomb, declared) + end, limits), McapRead::damaged);
    EXPECT_THAT(reason_, testing::HasSubstr("uncompressed"));
  }
  EXPECT_EQ(read(start + chunk("zstd", bomb, 65'536) + end, limits), McapRead::damaged);
  EXPECT_THAT(reason_, testing::HasSubstr("cannot be decompressed"));
  EXPECT_EQ(read(start + record(12, zeros) + end, limits), McapRead::damaged);
  EXPECT_THAT(reason_, testing::HasSubstr("more than"));
  EXPECT_EQ(read(start + '\x06' + number(~std::uint64_t{0}) + end, limits), McapRead::damaged);
}

TEST_F(Mcap, RefusesWhatIsNotInItsPlace) {
  const std::string start = kMagic + kHeader, end = kFooter + kMagic;
  const std::string footer_inside = kFooter;
  EXPECT_EQ(read(kMagic + kChannel + end), McapRead::damaged);
  EXPECT_EQ(read(start + kHeader + end), McapRead::damaged);
  EXPECT_EQ(read(start + chunk("", footer_inside, footer_inside.size()) + end), McapRead::damaged);
  EXPECT_EQ(read(start + chunk("lz4", "xx", 10) + end), McapRead::damaged);
  EXPECT_THAT(reason_, testing::HasSubstr("unsupported compression"));
  EXPECT_EQ(read(start + chunk("", kChannel, kChannel.size(), 1) + end), McapRead::damaged);
  EXPECT_THAT(reason_, testing::HasSubstr("checksum"));
  EXPECT_EQ(read(start + chunk("", kChannel.substr(0, 20), 20) + end), McapRead::damaged);
  EXPECT_EQ(read(start + record(15, number<std::uint32_t>(0)) + kMessage + end), McapRead::damaged);
  EXPECT_EQ(read(start + record(4, "x") + end), McapRead::damaged);
  // A map that runs over its own length.
  EXPECT_EQ(
      read(start + record(12, text("m") + number<std::uint32_t>(5) + text("k") + text("v")) + end),
      McapRead::damaged);
}

TEST_F(Mcap, WritesWhatItReads) {
  hal::McapWriter writer({.profile = "p", .library = "l"});
  std::string file;
  const auto take = [&] {
    const auto bytes = writer.pending();
    file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    writer.discard_pending();
  };
  const std::uint8_t data[] = {1, 2, 3};
  writer.add_attachment({.log_time_ns = 3, .name = "a", .media_type = "b", .data = data});
  writer.add_metadata({.name = "m", .pairs = {{"k", "v"}, {"", ""}}});
  take();
  const auto schema = writer.add_schema({.name = "S", .encoding = "ros2msg", .data = data});
  const auto first = writer.add_channel({.schema_id = schema, .topic = "/1"});
  const auto second = writer.add_channel({.schema_id = schema, .topic = "/2"});
  for (std::uint64_t i = 0; i < 100; ++i) {
    writer.add_message(i % 3 == 0 ? second : first, 1000 - i, data);
    if (i % 40 == 39) {
      ASSERT_TRUE(writer.finish_chunk());
      take();
    }
  }
  ASSERT_TRUE(writer.finish());
  take();
  EXPECT_EQ(read(file, {.is_strict = true}), McapRead::end) << reason_;
  EXPECT_EQ(messages_, 100);
}

}  // namespace
}  // namespace condyle
