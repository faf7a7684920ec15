// SPDX-License-Identifier: Apache-2.0
#include "box/service/latency_test.h"
#include "box/service/box.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "box/outlets/estimate_history.h"
#include "box/outlets/publisher.h"
#include "box/realtime/engine.h"
#include "box/realtime/real_time.h"
#include "hosted/devices/configured_facebow.h"

namespace condyle::box {
namespace {

std::string histogram_text(const char* name, const firmware::LatencyHistogram& histogram) {
  const auto us = [](TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-3; };
  std::string text = fmt::format(
      "{}: {} times, p50 {:.1f} us, p99 {:.1f} us, p99.9 {:.1f} us, at most {:.1f} us\n", name,
      histogram.count(), us(histogram.quantile_ns(0.5)), us(histogram.quantile_ns(0.99)),
      us(histogram.quantile_ns(0.999)), us(histogram.largest_ns()));
  // A line for each doubling from the first to the last that occurred.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> lines;  // ns, times
  std::uint64_t largest = 1;
  for (std::size_t bin = 0; bin < firmware::LatencyHistogram::kBins; bin += 16) {
    std::uint64_t times = 0;
    for (std::size_t i = bin; i < bin + 16; ++i) times += histogram.in_bin(i);
    if (times == 0 && lines.empty()) continue;
    lines.emplace_back(firmware::LatencyHistogram::bin_begin_ns(bin), times);
    largest = std::max(largest, times);
  }
  while (!lines.empty() && lines.back().second == 0) lines.pop_back();
  for (const auto& [begin_ns, times] : lines) {
    const auto width = static_cast<std::size_t>(50 * times / largest);
    text += fmt::format("  from {:>10.3f} us {:>10} {}\n", us(static_cast<TimeNs>(begin_ns)), times,
                        std::string(times > 0 ? std::max<std::size_t>(width, 1) : 0, '#'));
  }
  return text;
}

}  // namespace

std::string test_latency(const Configuration& configuration, double duration_s, hal::Clock& clock,
                         const std::function<bool()>& should_stop) {
  const SourceSettings& settings = configuration.facebow;
  host::ConfiguredFacebow facebow = configured(settings, clock);
  facebow.find(should_stop);
  ReconnectingSource source(facebow.source(), clock);
  const auto engine = std::make_unique<Engine>(source, facebow.profile(), configuration, clock);
  EstimateHistory history(1);
  Publisher publisher(history, configuration.udp_address, configuration.udp_port, clock,
                      configuration.pose.value_or(host::PoseChoice()), configuration.cycles);
  publisher.start(engine->outlet().ring(), [] {});
  engine->start();
  while (engine->scheduling().empty()) clock.sleep_until(clock.now_ns() + 1'000'000);
  const std::string memory = lock_memory();
  const TimeNs begin_ns = clock.now_ns(), end_ns = begin_ns + nanoseconds(duration_s);
  const bool shows_progress = isatty(STDERR_FILENO) != 0;
  while (!should_stop() && clock.now_ns() < end_ns) {
    clock.sleep_until(std::min(end_ns, clock.now_ns() + 100'000'000));
    if (shows_progress) {
      std::fprintf(stderr, "\r%.0f of %.0f s ", seconds(clock.now_ns() - begin_ns), duration_s);
    }
  }
  if (shows_progress) std::fputc('\n', stderr);
  engine->stop();
  publisher.stop();
  std::string text = fmt::format(
      "condyle {}: thread {}, memory {}, {} reports, {} estimates dropped\n", CONDYLE_VERSION,
      engine->scheduling(), memory, engine->counts().received, engine->outlet().ring().dropped());
  if (!configuration.node.empty()) {
    text += "the box makes these estimates: the test does not use [estimator] node\n";
  }
  if (facebow.synthetic() != nullptr) {
    text += histogram_text("wake-up by the kernel", facebow.synthetic()->wake_up());
  }
  return text + histogram_text("from report to estimate", engine->outlet().latency());
}

}  // namespace condyle::box
