// SPDX-License-Identifier: Apache-2.0
// The serial link to a target. By the first byte: any bytes as a line, each piece of which is
// accepted or refused and counted once; as a message, which is refused or says what its bytes say;
// as a payload, which arrives.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "condyle/hal/link/link_messages.h"

namespace {

using namespace condyle::hal;
using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

void require(bool condition) {
  if (!condition) std::abort();
}

// What is read and written again are the same bytes.
template <class Message>
void read(ByteSpan payload) {
  Message message;
  if (get(payload, message).reason != RefusalReason::none) return;
  Bytes written(payload.size());
  require(put(message, written) == payload.size());
  require(std::equal(written.begin(), written.end(), payload.begin()));
}

void read_message(std::uint8_t type, ByteSpan payload) {
  switch (static_cast<MessageType>(type)) {
    case MessageType::hello:
      return read<HelloMessage>(payload);
    case MessageType::layout: {
      LayoutMessage message;
      if (get(payload, message).reason == RefusalReason::none) find_layout_problem(message.layout);
      return read<LayoutMessage>(payload);
    }
    case MessageType::start:
      return read<StartMessage>(payload);
    case MessageType::report:
      return read<ReportMessage>(payload);
    case MessageType::finish:
      return read<FinishMessage>(payload);
    case MessageType::ask_health:
      return read<AskHealthMessage>(payload);
    case MessageType::reconnected:
      return read<ReconnectedMessage>(payload);
    case MessageType::greeting:
      return read<GreetingMessage>(payload);
    case MessageType::accepted:
      return read<AcceptedMessage>(payload);
    case MessageType::refused:
      return read<RefusedMessage>(payload);
    case MessageType::published_estimate:
      read<PublishedEstimateMessage<float>>(payload);
      return read<PublishedEstimateMessage<double>>(payload);
    case MessageType::recommended_estimate:
      read<RecommendedEstimateMessage<float>>(payload);
      return read<RecommendedEstimateMessage<double>>(payload);
    case MessageType::conclusion:
      read<ConclusionMessage<float>>(payload);
      return read<ConclusionMessage<double>>(payload);
    case MessageType::health:
      return read<HealthMessage>(payload);
    case MessageType::fault:
      return read<FaultMessage>(payload);
  }
}

void expect_next(FrameDecoder& decoder, FrameEncoder& encoder, std::uint8_t type,
                 ByteSpan payload) {
  std::array<std::uint8_t, kMaxFrameSize> line{};
  const std::size_t size = encoder.encode(type, payload, line);
  require((size == 0) == (payload.size() > kMaxPayload));
  const std::uint64_t accepted = decoder.counts().accepted;
  for (std::size_t i = 0; i < size; ++i) require(decoder.take(line[i]) == (i + 1 == size && i > 0));
  if (size == 0) return;
  const LinkFrame& frame = decoder.frame();
  require(decoder.counts().accepted == accepted + 1 && frame.type == type);
  require(std::equal(payload.begin(), payload.end(), frame.payload.begin(), frame.payload.end()));
}

void take_line(ByteSpan line) {
  FrameDecoder decoder;
  std::uint64_t pieces = 0;
  bool is_inside = false;
  for (const std::uint8_t byte : line) {
    pieces += is_inside && byte == 0 ? 1U : 0U;
    is_inside = byte != 0;
    if (decoder.take(byte)) read_message(decoder.frame().type, decoder.frame().payload);
  }
  require(decoder.counts().accepted + decoder.counts().refused() >= pieces);
  if (decoder.take(0)) read_message(decoder.frame().type, decoder.frame().payload);
  pieces += is_inside ? 1U : 0U;
  require(decoder.counts().accepted + decoder.counts().refused() == pieces);
  FrameEncoder encoder;
  expect_next(decoder, encoder, 1, line.first(std::min(line.size(), kMaxPayload)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const ByteSpan rest(data + 2, size - 2);
  switch (data[0] % 3) {
    case 0:
      take_line(ByteSpan(data + 1, size - 1));
      break;
    case 1:
      read_message(data[1], rest);
      break;
    default: {
      FrameDecoder decoder;
      FrameEncoder encoder;
      expect_next(decoder, encoder, data[1], rest);
      expect_next(decoder, encoder, 0, {});
      require(decoder.counts().refused() == 0 && decoder.counts().lost == 0);
    }
  }
  return 0;
}
