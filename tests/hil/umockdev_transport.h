// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "hil/looks.h"
#include "hil/mock_node.h"

namespace condyle::hil {

/// Which node of the fake facebow the host opens.
enum class Personality : std::uint8_t { hidraw, usbfs };

/// The fake facebow in umockdev's test bed, for programs started from this process. Delivered means
/// read by the program. umockdev calls back from a thread of its own.
class UmockdevTransport final : public host::fake::Transport {
 public:
  /// `interloper`: serial number of another device, which hidraw shows at every second plugging;
  /// empty: none. InputError where this is not run through umockdev-wrapper.
  UmockdevTransport(Personality personality, std::string interloper);
  ~UmockdevTransport() override;

  std::string name() const override;
  void plug() override;
  void unplug() override;
  void send(const host::fake::Packet& packet) override;
  bool can_fail() const override { return personality_ == Personality::usbfs; }
  bool knows_taken() const override { return true; }
  void serve(TimeNs deadline_ns) override;
  bool is_read() override;
  bool is_taken() override;
  host::fake::Deliveries deliveries() override;
  /// Until `begin`, nobody counts as a reader.
  void hold_back() { is_held_back_ = true; }
  void begin() { is_held_back_ = false; }
  /// True where no program has the device open, not even one that was unplugged.
  bool is_let_go();
  /// Counts as lost what no program will read any more; once all programs have ended.
  void settle();

 private:
  // Who opened which node.
  struct Client {
    UmockdevTransport& transport;
    MockNode& node;
  };

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static void on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  static void on_closed(gpointer client, GObject*);
  std::filesystem::path real_path(const std::string& node) const;
  void link(const std::string& node, const PtyGate& gate);
  void bury_oldest();
  MockNode& node_of(UMockdevIoctlClient* client);

  // Nodes of unplugged devices stay for a while: they open, then say ENODEV. A program that tries
  // to open one that is not there any more costs umockdev 0.17 one of 50 places in its table.
  static constexpr std::size_t kDeadNodes = 8;

  Personality personality_;
  std::string interloper_;
  bool is_held_back_ = false;
  std::optional<Looks> looks_;  // at the interloper, while it is plugged in
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool has_changed_ = false;
  host::fake::ReportQueue queue_;
  unsigned plugs_ = 0;
  MockNode* current_ = nullptr;
  std::deque<std::string> dead_;
  std::map<std::string, std::unique_ptr<MockNode>> nodes_;  // all that ever were
};

}  // namespace condyle::hil
