// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "box/box.h"
#include "box/http_client.h"
#include "support/paths.h"
#include "unit/temporary_folder.h"

namespace condyle::testing_support {

/// Waits until `holds`, for at most twenty seconds.
inline bool wait_for(const std::function<bool()>& holds) {
  for (int i = 0; i < 4000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return holds();
}

/// A box on a synthetic facebow, or any other, in this process.
class RunningBox {
 public:
  RunningBox() {
    configuration.facebow = {"facebow", box::SourceSettings::Kind::synth,
                             testing_support::source_path("/hal/profiles/condyle_facebow.toml"),
                             ""};
    configuration.folder = folder.path().string();
    configuration.reserve_bytes = 1'000'000;
    configuration.http_port = 0;
  }
  ~RunningBox() { stop(); }
  RunningBox(const RunningBox&) = delete;
  RunningBox& operator=(const RunningBox&) = delete;

  void start() {
    box = std::make_unique<box::Box>(configuration, clock, log);
    port = box->http_port();
    thread_ = std::thread([this] { box->run([this] { return stops_.load(); }); });
  }
  void stop() {
    stops_ = true;
    if (thread_.joinable()) thread_.join();
  }

  nlohmann::json status() const {
    return nlohmann::json::parse(get(port, "/v1/status").body, nullptr, false);
  }
  /// Waits for the first estimates.
  bool is_estimating() const {
    return wait_for([this] { return box->status().counts.estimates > 0; });
  }

  TemporaryFolder folder;  ///< of recordings
  box::Configuration configuration;
  hal::SteadyClock clock;
  box::BoxLog log{clock};
  std::unique_ptr<box::Box> box;
  std::uint16_t port = 0;

 private:
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace condyle::testing_support
