// SPDX-License-Identifier: Apache-2.0
#include "box/configuration.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "hosted/files/input_error.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;

class ConfigurationFile : public testing::Test {
 protected:
  Configuration load(const std::string& text) const {
    return load_configuration(folder_.write("box.toml", text));
  }
  std::string problem(const std::string& text) const {
    try {
      (void)load(text);
    } catch (const host::InputError& error) {
      return error.what();
    }
    return {};
  }
  testing_support::TemporaryFolder folder_;
  const std::string source_ = "[facebow]\nsource = \"synth:bow.toml\"\n";
};

TEST_F(ConfigurationFile, TheOneShippedIsTheDefaults) {
  const Configuration shipped =
      load_configuration(testing_support::source_path("/firmware/box/box.toml"));
  EXPECT_EQ(shipped.facebow.kind, SourceSettings::Kind::synth);
  // With all of its comments that are settings taken for such.
  std::string text =
      testing_support::read_file(testing_support::source_path("/firmware/box/box.toml"));
  std::string all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_setting = line.starts_with("# ") && line.find(" = ") < 20 &&
                            line.find("serial") == std::string::npos &&
                            line.find("source") == std::string::npos &&
                            line.find("\"\"") == std::string::npos;
    all += (is_setting ? line.substr(2) : line) + "\n";
  }
  const Configuration same = load(all);
  EXPECT_EQ(same.followed.point, shipped.followed.point);
  EXPECT_EQ(same.followed.axis, shipped.followed.axis);
  EXPECT_EQ(same.lag, shipped.lag);
  EXPECT_EQ(same.pose.has_value(), shipped.pose.has_value());
  EXPECT_EQ(same.cycles.has_value(), shipped.cycles.has_value());
  EXPECT_EQ(same.priority, shipped.priority);
  EXPECT_EQ(same.node_baud, shipped.node_baud);
  EXPECT_EQ(same.node_late_ns, shipped.node_late_ns);
  EXPECT_EQ(same.reserve_bytes, shipped.reserve_bytes);
  EXPECT_EQ(same.udp_address, shipped.udp_address);
  EXPECT_EQ(same.udp_port, shipped.udp_port);
  EXPECT_EQ(same.http_address, shipped.http_address);
  EXPECT_EQ(same.http_port, shipped.http_port);
  EXPECT_EQ(same.most_listeners, shipped.most_listeners);
}

TEST_F(ConfigurationFile, TakesTheDirectionInWhichTheJawCloses) {
  EXPECT_FALSE(load(source_).cycles.has_value());
  const auto cycles =
      load(source_ + "axis = \"y\"\n[cycles]\nfind = true\nclosing = \"negative\"\n").cycles;
  ASSERT_TRUE(cycles.has_value());
  EXPECT_EQ(cycles->followed, Axis::y);
  EXPECT_FALSE(cycles->closes_upward);
}

TEST_F(ConfigurationFile, TakesThePoseAndPointsOfTheJaw) {
  EXPECT_FALSE(load(source_).pose.has_value());
  const std::string pose = source_ + "[pose]\nestimate = true\n";
  EXPECT_TRUE(load(pose).pose->points.empty());
  const std::string point = "[jaw_point.incisor]\nposition_mm = [0, 80, -30]\n";
  const Configuration read = load(pose + "twist_axis = \"y\"\n" + point);
  EXPECT_EQ(read.pose->twist_axis, Axis::y);
  ASSERT_EQ(read.pose->points.size(), 1U);
  EXPECT_EQ(read.pose->points[0].name, "incisor");
  EXPECT_EQ(read.pose->points[0].jaw_m, 1e-3 * Eigen::Vector3d(0, 80, -30));
  EXPECT_THAT(problem(source_ + point), HasSubstr("a point of the jaw needs the pose; write "
                                                  "estimate = true in [pose]"));
  EXPECT_THAT(problem(pose + "[jaw_point.a]\n"), HasSubstr("jaw_point.a has no position"));
  EXPECT_THAT(problem(pose + "[jaw_point.centre]\nposition_mm = [0, 0, 0]\n"),
              HasSubstr("centre is already the name of a value"));
  EXPECT_THAT(problem(pose + "[estimator]\nnode = \"unix:s\"\n"),
              HasSubstr("a microcontroller does not estimate the pose"));
}

TEST_F(ConfigurationFile, TakesFilesFromItsOwnFolder) {
  const Configuration read = load(
      "[facebow]\nsource = \"usb:profiles/bow.toml\"\nserial = \"7\"\npoint = 3\naxis = \"y\"\n"
      "[companion.force]\nsource = \"hid:/etc/force.toml\"\n[recording]\nfolder = \"logs\"\n");
  EXPECT_EQ(read.facebow.kind, SourceSettings::Kind::usb);
  EXPECT_EQ(read.facebow.file, folder_ / "profiles/bow.toml");
  EXPECT_EQ(read.facebow.serial, "7");
  EXPECT_EQ(read.followed.point, 3);
  EXPECT_EQ(read.followed.axis, Axis::y);
  ASSERT_EQ(read.companions.size(), 1U);
  EXPECT_EQ(read.companions[0].name, "force");
  EXPECT_EQ(read.companions[0].file, "/etc/force.toml");
  EXPECT_EQ(read.folder, folder_ / "logs");
  const auto node = [this](const std::string& name) {
    return load(source_ + "[estimator]\nnode = \"" + name + "\"\n").node;
  };
  EXPECT_EQ(node(""), "");
  EXPECT_EQ(node("serial:/dev/ttyACM0"), "/dev/ttyACM0");
  EXPECT_EQ(node("unix:line"), "unix:" + (folder_ / "line"));
}

TEST_F(ConfigurationFile, ReadsStreams) {
  const Configuration read = load(
      "[facebow]\nsource = \"lsl:Jaw@192.0.2.7\"\nchannels = \"x, y, z\"\nunit = \"cm\"\n"
      "[lsl]\nname = \"Out\"\n");
  ASSERT_TRUE(read.facebow.stream);
  EXPECT_EQ(read.facebow.stream->place, "Jaw@192.0.2.7");
  EXPECT_THAT(read.facebow.stream->choice.channels, testing::ElementsAre("x", "y", "z"));
  EXPECT_EQ(read.facebow.stream->choice.unit, "cm");
  EXPECT_EQ(read.lsl_out, "Out@127.0.0.1");
  EXPECT_EQ(load(source_).lsl_out, "");
}

TEST_F(ConfigurationFile, SaysWhatIsWrongAndWhere) {
  const std::string many = [] {
    std::string text;
    for (char name = 'a'; name < 'h'; ++name) {
      text.append("[companion.").append(1, name).append("]\nsource = \"hid:x\"\n");
    }
    return text;
  }();
  const std::pair<std::string, const char*> cases[] = {
      {"", "give one, such as"},
      {"[facebow]\nsource = \"lsl:\"\n", "is not the name of a stream"},
      {"[facebow]\nsource = \"lsl:Jaw\"\nunit = \"inch\"\n", "unit"},
      {source_ + "unit = \"mm\"\n", "unit"},
      {source_ + "[companion.a]\nsource = \"lsl:Force\"\n", "a companion must be a device"},
      {source_ + "[lsl]\nname = \"Jaw\"\naddress = \"::1\"\n", "is not a numeric IPv4 address"},
      {source_ + "[lsl]\nname = \"Jaw\"\naddress = \"224.0.0.1\"\n", "multicast"},
      {"[facebow]\nsource = \"serial:x\"\n", "box.toml:2:10: \"serial:x\" is not a source"},
      {"[facebow]\nsource = \"hid:\"\n", "does not name a file"},
      {"[facebow]\nsource = \"hid\"\n", "does not name a file"},
      {"[facebow]\nsource = \"synth:x\"\nserial = \"1\"\n", "only devices have a serial number"},
      {source_ + "point = 4\n", "point"},
      {source_ + "[companion.a]\nsource = \"file:x\"\n", "a companion must be a device"},
      {source_ + many, "too many companions"},
      {source_ + "[companion.markers]\nsource = \"hid:x\"\n", "is not a valid companion name"},
      {source_ + "[companion.\"left masseter\"]\nsource = \"hid:x\"\n",
       "is not a valid companion name"},
      {source_ + "[http]\nmost_listeners = 101\n", "most_listeners"},
      {source_ + "[estimator]\nlag_samples = 17\n", "lag_samples"},
      {source_ + "[estimator]\npriority = 99\n", "priority"},
      {source_ + "[estimator]\nnode = \"/dev/ttyACM0\"\n",
       "\"/dev/ttyACM0\" is not a line to a microcontroller; write ser"},
      {source_ + "[estimator]\nnode = \"serial:\"\n", "is not a line"},
      {source_ + "[estimator]\nnode_baud = 300\n", "node_baud"},
      {source_ + "[estimator]\nnode_baud = 250000\n",
       "serial ports do not support 250000 baud; give one of 9600, 19200,"},
      {source_ + "[estimator]\nnode_late_ms = 0\n", "node_late_ms"},
      {source_ + "[udp]\naddress = \"localhost\"\n", "is not a numeric address"},
      {source_ + "[udp]\naddress = \"127.0.0.1\\u0000x\"\n", "is not a numeric address"},
      {source_ + "[udp]\nport = 65536\n", "port"},
      {source_ + "[http]\naddress = \"0.0.0.0\"\n", "without a token"},
      {source_ + "[http]\nadress = \"::1\"\n", "adress"},
      {source_ + "[recording]\nreserve_MB = -1\n", "reserve_MB"},
      {source_ + "[http\n", "box.toml:3"}};
  for (const auto& [text, words] : cases) EXPECT_THAT(problem(text), HasSubstr(words)) << text;
}

TEST_F(ConfigurationFile, TakesOnlyATokenThatOthersCannotRead) {
  const std::string text = source_ + "[http]\naddress = \"0.0.0.0\"\ntoken_file = \"token\"\n";
  const std::string token = folder_.write("token", "0123456789abcdef\n");
  const auto permit = [&token](unsigned mode) {
    std::filesystem::permissions(token, std::filesystem::perms(mode));
  };
  permit(0644);
  EXPECT_THAT(problem(text), HasSubstr("chmod 640"));
  permit(0600);
  EXPECT_EQ(load(text).token, "0123456789abcdef");
  for (const char* wrong : {"", "short", "0123456789abcdef\nmore", "0123456789 abcdef"}) {
    (void)folder_.write("token", wrong);
    EXPECT_THAT(problem(text), HasSubstr("does not contain a usable token")) << wrong;
  }
}

TEST(Loopback, IsWhatNoOtherMachineReaches) {
  for (const char* address : {"127.0.0.1", "127.255.1.2", "::1"}) {
    EXPECT_TRUE(is_loopback(address)) << address;
  }
  for (const char* address : {"", "0.0.0.0", "128.0.0.1", "::", "localhost", "127.1", "fe80::1"}) {
    EXPECT_FALSE(is_loopback(address)) << address;
  }
  using namespace std::string_view_literals;
  for (const std::string_view address : {"127.0.0.1\0.example.org"sv, "::1\0O"sv, "::1\0"sv}) {
    EXPECT_FALSE(is_loopback(address)) << address.data();
  }
}

}  // namespace
}  // namespace condyle::box
