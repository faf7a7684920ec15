// SPDX-License-Identifier: Apache-2.0
// The summary of the files that we write, by which other programs find messages without reading
// all. Read here as the MCAP specification lays it out, by nothing of ours.
#include <gmock/gmock.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "condyle/hal/log/mcap_writer.h"

namespace condyle {
namespace {

constexpr int kFooter = 0x02, kSchema = 0x03, kChannel = 0x04, kMessage = 0x05, kChunk = 0x06,
              kMessageIndex = 0x07, kChunkIndex = 0x08, kAttachment = 0x09, kAttachmentIndex = 0x0A,
              kStatistics = 0x0B, kMetadata = 0x0C, kMetadataIndex = 0x0D, kSummaryOffset = 0x0E;
constexpr std::uint64_t kHead = 9, kMagic = 8;

// Bytes, taken one number or text after the other.
class Cursor {
 public:
  explicit Cursor(std::string bytes) : bytes_(std::move(bytes)) {}

  // Not inlined: GCC 12 then takes the bytes for uninitialised.
  template <typename Number>
  [[gnu::noinline]] Number number() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes_.at(at_++))} << (8 * i);
    }
    return static_cast<Number>(value);
  }
  std::string text() { return take(number<std::uint32_t>()); }
  std::string take(std::size_t size) {
    EXPECT_LE(size, bytes_.size() - at_);
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  bool is_at_end() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

struct Record {
  int opcode;
  std::string content;
};

Record record_at(const std::string& bytes, std::uint64_t offset) {
  Cursor cursor(bytes.substr(offset));
  const int opcode = cursor.number<std::uint8_t>();
  return {opcode, cursor.take(cursor.number<std::uint64_t>())};
}

std::vector<Record> records_in(const std::string& bytes, std::uint64_t begin, std::uint64_t end) {
  std::vector<Record> records;
  while (begin < end) {
    records.push_back(record_at(bytes, begin));
    begin += kHead + records.back().content.size();
  }
  EXPECT_EQ(begin, end);
  return records;
}

// Of two channels: 66 messages and 34, each a ns before the one before, in three chunks.
class McapSummary : public testing::Test {
 protected:
  void SetUp() override {
    hal::McapWriter writer({.profile = "p", .library = "l"});
    const std::uint8_t data[] = {1, 2, 3};
    writer.add_attachment(
        {.log_time_ns = 3, .create_time_ns = 4, .name = "a", .media_type = "b", .data = data});
    writer.add_metadata({.name = "m", .pairs = {{"k", "v"}}});
    const auto schema = writer.add_schema({.name = "S", .encoding = "ros2msg", .data = data});
    const auto first = writer.add_channel({.schema_id = schema, .topic = "/1"});
    const auto second = writer.add_channel({.schema_id = schema, .topic = "/2"});
    for (std::uint64_t i = 0; i < 100; ++i) {
      writer.add_message(i % 3 == 0 ? second : first, 1000 - i, data);
      if (i % 40 == 39) {
        ASSERT_TRUE(writer.finish_chunk());
      }
    }
    ASSERT_TRUE(writer.finish());
    const auto bytes = writer.pending();
    file_.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());

    const std::uint64_t footer = file_.size() - kMagic - kHead - 20;
    ASSERT_EQ(record_at(file_, footer).opcode, kFooter);
    Cursor cursor(record_at(file_, footer).content);
    const auto summary = cursor.number<std::uint64_t>(), offsets = cursor.number<std::uint64_t>();
    summary_ = records_in(file_, summary, offsets);
    offsets_ = records_in(file_, offsets, footer);
  }
  std::vector<Cursor> summary_of(int opcode) const {
    std::vector<Cursor> found;
    for (const Record& record : summary_) {
      if (record.opcode == opcode) found.emplace_back(record.content);
    }
    return found;
  }

  std::string file_;
  std::vector<Record> summary_, offsets_;
};

TEST_F(McapSummary, FindsTheRecordsOfEachKind) {
  std::map<int, std::size_t> counts;
  for (const Record& offset : offsets_) {
    ASSERT_EQ(offset.opcode, kSummaryOffset);
    Cursor cursor(offset.content);
    const int opcode = cursor.number<std::uint8_t>();
    const auto start = cursor.number<std::uint64_t>(), length = cursor.number<std::uint64_t>();
    for (const Record& record : records_in(file_, start, start + length)) {
      EXPECT_EQ(record.opcode, opcode);
      ++counts[opcode];
    }
  }
  EXPECT_EQ(counts, (std::map<int, std::size_t>{{kSchema, 1},
                                                {kChannel, 2},
                                                {kChunkIndex, 3},
                                                {kAttachmentIndex, 1},
                                                {kStatistics, 1},
                                                {kMetadataIndex, 1}}));
  EXPECT_EQ(summary_.size(), 9U);
}

TEST_F(McapSummary, CountsMessages) {
  auto found = summary_of(kStatistics);
  ASSERT_EQ(found.size(), 1U);
  Cursor& statistics = found[0];
  EXPECT_EQ(statistics.number<std::uint64_t>(), 100U);   // messages
  EXPECT_EQ(statistics.number<std::uint16_t>(), 1U);     // schemas
  EXPECT_EQ(statistics.number<std::uint32_t>(), 2U);     // channels
  EXPECT_EQ(statistics.number<std::uint32_t>(), 1U);     // attachments
  EXPECT_EQ(statistics.number<std::uint32_t>(), 1U);     // metadata
  EXPECT_EQ(statistics.number<std::uint32_t>(), 3U);     // chunks
  EXPECT_EQ(statistics.number<std::uint64_t>(), 901U);   // first time (ns)
  EXPECT_EQ(statistics.number<std::uint64_t>(), 1000U);  // last time (ns)
  Cursor channels(statistics.text());
  EXPECT_EQ(channels.number<std::uint16_t>(), 1U);
  EXPECT_EQ(channels.number<std::uint64_t>(), 66U);
  EXPECT_EQ(channels.number<std::uint16_t>(), 2U);
  EXPECT_EQ(channels.number<std::uint64_t>(), 34U);
  EXPECT_TRUE(channels.is_at_end());
  EXPECT_TRUE(statistics.is_at_end());
}

TEST_F(McapSummary, FindsEveryMessage) {
  // The first time of each chunk, its last, its messages.
  std::vector<std::tuple<std::uint64_t, std::uint64_t, int>> chunks;
  for (Cursor& index : summary_of(kChunkIndex)) {
    const auto first_ns = index.number<std::uint64_t>(), last_ns = index.number<std::uint64_t>();
    const auto start = index.number<std::uint64_t>(), length = index.number<std::uint64_t>();
    Cursor offsets(index.text());
    const auto indices_length = index.number<std::uint64_t>();
    EXPECT_EQ(index.text(), "zstd");
    const auto compressed = index.number<std::uint64_t>(), size = index.number<std::uint64_t>();
    EXPECT_TRUE(index.is_at_end());

    const Record chunk = record_at(file_, start);
    ASSERT_EQ(chunk.opcode, kChunk);
    ASSERT_EQ(kHead + chunk.content.size(), length);
    std::string messages(size, '\0');
    ASSERT_EQ(ZSTD_decompress(messages.data(), size,
                              chunk.content.data() + chunk.content.size() - compressed, compressed),
              size);

    std::uint64_t indices_end = start + length;
    int count = 0;
    while (!offsets.is_at_end()) {
      const auto channel = offsets.number<std::uint16_t>();
      const auto offset = offsets.number<std::uint64_t>();
      EXPECT_EQ(offset, indices_end);
      const Record record = record_at(file_, offset);
      ASSERT_EQ(record.opcode, kMessageIndex);
      indices_end += kHead + record.content.size();
      Cursor entries(record.content);
      EXPECT_EQ(entries.number<std::uint16_t>(), channel);
      Cursor places(entries.text());
      for (; !places.is_at_end(); ++count) {
        const auto time_ns = places.number<std::uint64_t>();
        const Record message = record_at(messages, places.number<std::uint64_t>());
        ASSERT_EQ(message.opcode, kMessage);
        Cursor cursor(message.content);
        EXPECT_EQ(cursor.number<std::uint16_t>(), channel);
        EXPECT_EQ(channel, (1000 - time_ns) % 3 == 0 ? 2 : 1);
        cursor.number<std::uint32_t>();  // its number
        EXPECT_EQ(cursor.number<std::uint64_t>(), time_ns);
      }
    }
    EXPECT_EQ(indices_end, start + length + indices_length);
    chunks.emplace_back(first_ns, last_ns, count);
  }
  EXPECT_THAT(chunks, testing::ElementsAre(std::tuple(961, 1000, 40), std::tuple(921, 960, 40),
                                           std::tuple(901, 920, 20)));
}

TEST_F(McapSummary, FindsAttachmentsAndMetadata) {
  auto attachments = summary_of(kAttachmentIndex), metadata = summary_of(kMetadataIndex);
  ASSERT_EQ(attachments.size(), 1U);
  ASSERT_EQ(metadata.size(), 1U);
  Cursor& attachment = attachments[0];
  const Record attached = record_at(file_, attachment.number<std::uint64_t>());
  EXPECT_EQ(attached.opcode, kAttachment);
  EXPECT_EQ(attachment.number<std::uint64_t>(), kHead + attached.content.size());
  EXPECT_EQ(attachment.number<std::uint64_t>(), 3U);  // log time (ns)
  EXPECT_EQ(attachment.number<std::uint64_t>(), 4U);  // create time (ns)
  EXPECT_EQ(attachment.number<std::uint64_t>(), 3U);  // bytes
  EXPECT_EQ(attachment.text(), "a");
  EXPECT_EQ(attachment.text(), "b");
  EXPECT_TRUE(attachment.is_at_end());
  const Record named = record_at(file_, metadata[0].number<std::uint64_t>());
  EXPECT_EQ(named.opcode, kMetadata);
  EXPECT_EQ(metadata[0].number<std::uint64_t>(), kHead + named.content.size());
  EXPECT_EQ(metadata[0].text(), "m");
  EXPECT_TRUE(metadata[0].is_at_end());
}

// A long file's index, kept elsewhere until the end.
class Store : public hal::McapIndexStore {
 public:
  explicit Store(std::size_t room) : room_(room) {}
  bool append(std::uint64_t offset, std::span<const std::uint8_t> bytes) override {
    if (offset + bytes.size() > room_) return false;
    kept.resize(offset);
    kept.insert(kept.end(), bytes.begin(), bytes.end());
    return true;
  }
  bool read(std::uint64_t offset, std::span<std::uint8_t> bytes) override {
    std::copy_n(kept.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
    return true;
  }
  std::vector<std::uint8_t> kept;

 private:
  std::size_t room_;
};

// Of 3,000 chunks; `most_pending` is told how much was written at once.
std::string long_file(hal::McapWriter& writer, std::size_t& most_pending) {
  std::string file;
  const auto write = [&] {
    most_pending = std::max(most_pending, writer.pending().size());
    file.append(writer.pending().begin(), writer.pending().end());
    writer.discard_pending();
    return true;
  };
  const auto schema = writer.add_schema({.name = "S", .encoding = "ros2msg", .data = {}});
  const auto channel = writer.add_channel(
      {.schema_id = schema, .topic = "/t", .message_encoding = "cdr", .metadata = {}});
  for (std::uint64_t time_ns = 0; time_ns < 3000; ++time_ns) {
    writer.add_message(channel, time_ns, {});
    EXPECT_TRUE(writer.finish_chunk());
    write();
  }
  EXPECT_TRUE(writer.finish(write));
  write();
  return file;
}

TEST(McapIndexStore, ChangesNoByteOfTheFile) {
  const auto file_with = [](Store* store) {
    hal::McapWriter writer({.profile = "", .library = ""}, store);
    std::size_t most_pending = 0;
    std::string file = long_file(writer, most_pending);
    EXPECT_LT(most_pending, 140'000U);
    return file;
  };
  const std::string expected = file_with(nullptr);
  Store large(1'000'000), small(100'000);
  EXPECT_EQ(file_with(&large), expected);
  EXPECT_GT(large.kept.size(), 190'000U);  // all but the last piece
  // A full disk takes the first part.
  EXPECT_EQ(file_with(&small), expected);
  EXPECT_GT(small.kept.size(), 50'000U);
}

TEST(McapWriter, WritesTheSameBytesInTheMemoryOfAnotherFile) {
  const hal::McapHeader header{.profile = "", .library = ""};
  std::size_t most_pending = 0;
  hal::McapWriter first(header);
  const std::string expected = long_file(first, most_pending);
  Store store(1'000'000);
  hal::McapWriter writer({.profile = "p", .library = "l"}, &store);
  const std::uint8_t data[] = {1, 2, 3};
  writer.add_attachment(
      {.log_time_ns = 3, .create_time_ns = 4, .name = "a", .media_type = "b", .data = data});
  writer.add_metadata({.name = "m", .pairs = {{"k", "v"}}});
  EXPECT_NE(long_file(writer, most_pending), expected);
  writer.begin_file(header);
  EXPECT_EQ(long_file(writer, most_pending), expected);
  // One that was not finished leaves nothing either.
  writer.begin_file(header, &store);
  const auto schema = writer.add_schema({.name = "T", .encoding = "ros2msg", .data = data});
  const auto channel = writer.add_channel(
      {.schema_id = schema, .topic = "/u", .message_encoding = "cdr", .metadata = {}});
  writer.add_message(channel, 5'000, data);
  ASSERT_TRUE(writer.finish_chunk());
  writer.add_message(channel, 6'000, data);
  writer.begin_file(header);
  EXPECT_EQ(long_file(writer, most_pending), expected);
}

}  // namespace
}  // namespace condyle
