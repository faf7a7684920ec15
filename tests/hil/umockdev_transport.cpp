// SPDX-License-Identifier: Apache-2.0
#include "hil/umockdev_transport.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "hil/mock_hidraw.h"
#include "hil/mock_usbfs.h"
#include "hosted/files/input_error.h"

namespace condyle::hil {

using namespace host::fake;
using host::InputError;

namespace {

// umockdev's own complaint about something that must work.
void check(gboolean good, GError* error) {
  if (good) return;
  const std::string problem = error != nullptr ? error->message : "does not do what it should";
  g_clear_error(&error);
  throw InputError("umockdev", problem, "its version may not be the one known, 0.17");
}

}  // namespace

UmockdevTransport::UmockdevTransport(Personality personality, std::string interloper)
    : personality_(personality), interloper_(std::move(interloper)) {
  testbed_ = umockdev_testbed_new();
  if (!umockdev_in_mock_environment()) {
    g_object_unref(testbed_);
    throw InputError("umockdev", "is not loaded", "run this through umockdev-wrapper");
  }
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
  g_signal_connect(handler_, "handle-read", G_CALLBACK(on_read), this);
  g_signal_connect(handler_, "client-connected", G_CALLBACK(on_connected), this);
}

// The test bed joins umockdev's thread; no call comes after that.
UmockdevTransport::~UmockdevTransport() {
  g_object_unref(testbed_);
  g_object_unref(handler_);
}

std::string UmockdevTransport::name() const {
  return personality_ == Personality::hidraw ? "umockdev hidraw" : "umockdev usbfs";
}

MockNode& UmockdevTransport::node_of(UMockdevIoctlClient* client) {
  return *nodes_.at(umockdev_ioctl_client_get_devnode(client));
}

gboolean UmockdevTransport::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client,
                                     gpointer self) {
  auto& transport = *static_cast<UmockdevTransport*>(self);
  const std::lock_guard lock(transport.mutex_);
  transport.has_changed_ = true;
  transport.changed_.notify_all();
  return transport.node_of(client).ioctl(client);
}

gboolean UmockdevTransport::on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client,
                                    gpointer self) {
  auto& transport = *static_cast<UmockdevTransport*>(self);
  const std::lock_guard lock(transport.mutex_);
  transport.has_changed_ = true;
  transport.changed_.notify_all();
  return transport.node_of(client).read(client);
}

// Also called where a program opens a node in vain that was there before; that one is never closed.
void UmockdevTransport::on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client,
                                     gpointer self) {
  auto& transport = *static_cast<UmockdevTransport*>(self);
  const std::lock_guard lock(transport.mutex_);
  transport.has_changed_ = true;
  transport.changed_.notify_all();
  MockNode& node = transport.node_of(client);
  if (&node != transport.current_) return;
  g_object_weak_ref(G_OBJECT(client), on_closed, new Client{transport, node});
  node.open();
}

// umockdev 0.17 does not say that a client closed the node, but then drops its object.
void UmockdevTransport::on_closed(gpointer client, GObject*) {
  const std::unique_ptr<Client> closed(static_cast<Client*>(client));
  UmockdevTransport& transport = closed->transport;
  const std::lock_guard lock(transport.mutex_);
  transport.has_changed_ = true;
  transport.changed_.notify_all();
  closed->node.close();
}

void UmockdevTransport::plug() {
  MockNode* node = nullptr;
  bool is_interloper = false;
  {
    const std::lock_guard lock(mutex_);
    std::unique_ptr<MockNode> made;
    if (personality_ == Personality::hidraw) {
      is_interloper = plugs_ % 2 == 1 && !interloper_.empty();
      made = std::make_unique<MockHidraw>(queue_, plugs_,
                                          is_interloper ? interloper_ : std::string(kSerial));
    } else {
      made = std::make_unique<MockUsbfs>(queue_, plugs_);
    }
    ++plugs_;
    node = made.get();
    nodes_[node->names().node] = std::move(made);
    current_ = node;
  }
  bury_oldest();
  const MockNames& names = node->names();
  link(names.node, node->gate());
  GError* error = nullptr;
  check(umockdev_testbed_attach_ioctl(testbed_, names.node.c_str(), handler_, &error), error);
  for (const std::string& device : names.devices) {
    check(umockdev_testbed_add_from_string(testbed_, device.c_str(), &error), error);
  }
  if (is_interloper) looks_.emplace(real_path("/sys" + names.identity));
}

// In the kernel's order: when a program learns that the device has gone, no list shows it any more,
// and its node cannot be opened.
void UmockdevTransport::unplug() {
  MockNode* node = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (current_ == nullptr) return;
    node = current_;
  }
  const MockNames& names = node->names();
  for (auto path = names.paths.rbegin(); path != names.paths.rend(); ++path) {
    const std::string full = "/sys" + *path;
    umockdev_testbed_uevent(testbed_, full.c_str(), "remove");
    umockdev_testbed_remove_device(testbed_, full.c_str());
  }
  const std::lock_guard lock(mutex_);
  current_ = nullptr;
  looks_.reset();
  std::filesystem::remove(real_path(names.node));
  node->unplug();
  node->hang_up();
  dead_.push_back(names.node);
}

std::filesystem::path UmockdevTransport::real_path(const std::string& node) const {
  gchar* const root = umockdev_testbed_get_root_dir(testbed_);
  const std::string path = root + node;
  g_free(root);
  return path;
}

void UmockdevTransport::link(const std::string& node, const PtyGate& gate) {
  const std::filesystem::path path = real_path(node), temporary = path.string() + ".new";
  std::filesystem::create_directories(path.parent_path());
  std::filesystem::create_symlink(gate.path(), temporary);
  std::filesystem::rename(temporary, path);
}

void UmockdevTransport::bury_oldest() {
  if (dead_.size() < kDeadNodes) return;
  GError* error = nullptr;
  check(umockdev_testbed_detach_ioctl(testbed_, dead_.front().c_str(), &error), error);
  dead_.pop_front();
}

void UmockdevTransport::send(const Packet& packet) {
  const std::lock_guard lock(mutex_);
  if (current_ != nullptr) current_->send(packet);
}

void UmockdevTransport::serve(TimeNs deadline_ns) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock,
                      std::chrono::steady_clock::time_point(std::chrono::nanoseconds(deadline_ns)),
                      [this] { return has_changed_; });
  has_changed_ = false;
}

// No program waits for the interloper: it goes on once one listed the devices twice, and so did not
// open it after the first time.
bool UmockdevTransport::is_read() {
  const std::lock_guard lock(mutex_);
  return current_ != nullptr && !is_held_back_ &&
         (current_->is_read() || (looks_ && looks_->count() > 1));
}

bool UmockdevTransport::is_taken() {
  const std::lock_guard lock(mutex_);
  return current_ == nullptr || current_->is_taken();
}

bool UmockdevTransport::is_let_go() {
  const std::lock_guard lock(mutex_);
  return std::none_of(nodes_.begin(), nodes_.end(),
                      [](const auto& node) { return node.second->is_open(); });
}

void UmockdevTransport::settle() {
  const std::lock_guard lock(mutex_);
  for (const auto& [path, node] : nodes_) node->forget();
}

Deliveries UmockdevTransport::deliveries() {
  const std::lock_guard lock(mutex_);
  return queue_.deliveries();
}

}  // namespace condyle::hil
