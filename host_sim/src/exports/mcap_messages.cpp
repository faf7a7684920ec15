// SPDX-License-Identifier: Apache-2.0
#include "exports/mcap_messages.h"

#include <initializer_list>
#include <utility>

#include "output/event_text.h"

namespace condyle::host {
namespace {

// A definition and those it needs, each once.
std::string with_parts(std::string definition, std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    definition += std::string(80, '=') + "\nMSG: " + part;
  }
  return definition;
}

constexpr const char* kTime = "builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
constexpr const char* kHeader = "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kPoint = "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* kVector = "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* kQuaternion =
    "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
constexpr const char* kPose =
    "geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
constexpr const char* kTransform =
    "geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation\n";
constexpr const char* kTransformStamped =
    "geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform\n";
constexpr const char* kQuantity =
    "condyle_msgs/Quantity\n"
    "# NaN: not known.\n"
    "uint8 NOT_COMPUTED=0\n"
    "uint8 ASSUMED=1   # the prior or the tuning determines it, not the subject\n"
    "uint8 DERIVED=2   # a measured quantity times a named assumption\n"
    "uint8 MEASURED=3  # the measurements determine it\n"
    "float64 value\n"
    "float64 standard_deviation\n"
    "uint8 provenance\n";
constexpr const char* kAxis =
    "condyle_msgs/AxisEstimate\n"
    "float64 measured_position_m\n"
    "condyle_msgs/Quantity position_m\n"
    "condyle_msgs/Quantity velocity_m_s\n"
    "condyle_msgs/Quantity acceleration_m_s2\n"
    "condyle_msgs/Quantity force_n  # N: the assumed mass times acceleration\n"
    "float64 innovation_m\n"
    "float64 innovation_sd_m\n"
    "float64 noise_sd_m\n";
// Along the followed axis; not computed without a drive.
constexpr const char* kIdentified =
    "condyle_msgs/Quantity friction_ns_m  # Ns/m, along the followed axis; needs a drive\n"
    "condyle_msgs/Quantity mass_kg\n"
    "string friction_limit  # why it is withheld\n"
    "string mass_limit\n"
    "string events  # what was unusual about the sample, separated by |\n";

void write_header(CdrWriter& out, TimeNs time_ns, std::string_view frame) {
  out.begin();
  out.time(time_ns);
  out.text(frame);
}

void write_quaternion(CdrWriter& out, const double* wxyz) {
  for (const int i : {1, 2, 3, 0}) out.number(wxyz[i]);
}

void write_quantity(CdrWriter& out, const Quantity<double>& quantity) {
  out.number(quantity.value);
  out.number(quantity.standard_deviation);
  out.number(static_cast<std::uint8_t>(quantity.provenance));
}

void write_axis(CdrWriter& out, const AxisEstimate<double>& axis) {
  out.number(axis.measured_position_m);
  for (const auto* quantity :
       {&axis.position_m, &axis.velocity_m_s, &axis.acceleration_m_s2, &axis.force_N}) {
    write_quantity(out, *quantity);
  }
  for (const double number : {axis.innovation_m, axis.innovation_sd_m, axis.noise_sd_m}) {
    out.number(number);
  }
}

}  // namespace

MessageType point_type() {
  return {
      "geometry_msgs/msg/PointStamped",
      with_parts("std_msgs/Header header\ngeometry_msgs/Point point\n", {kHeader, kTime, kPoint})};
}

MessageType pose_type() {
  return {"geometry_msgs/msg/PoseStamped",
          with_parts("std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                     {kHeader, kTime, kPose, kPoint, kQuaternion})};
}

MessageType transforms_type() {
  return {"tf2_msgs/msg/TFMessage",
          with_parts("geometry_msgs/TransformStamped[] transforms\n",
                     {kTransformStamped, kHeader, kTime, kTransform, kVector, kQuaternion})};
}

MessageType log_type() {
  return {"rcl_interfaces/msg/Log",
          with_parts("byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n"
                     "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\n"
                     "string file\nstring function\nuint32 line\n",
                     {kTime})};
}

MessageType value_type() {
  return {"condyle_msgs/msg/Value",
          with_parts("std_msgs/Header header\nfloat64 value  # NaN: missing\n", {kHeader, kTime})};
}

MessageType estimate_type(int axis_count) {
  const std::string head = "std_msgs/Header header\n";
  if (axis_count == 1) {
    return {"condyle_msgs/msg/AxisMotion",
            with_parts(head + "condyle_msgs/AxisEstimate axis\n" + kIdentified,
                       {kHeader, kTime, kAxis, kQuantity})};
  }
  return {"condyle_msgs/msg/PointMotion",
          with_parts(head +
                         "condyle_msgs/AxisEstimate x\ncondyle_msgs/AxisEstimate y\n"
                         "condyle_msgs/AxisEstimate z\n" +
                         kIdentified,
                     {kHeader, kTime, kAxis, kQuantity})};
}

void write_point(CdrWriter& out, TimeNs time_ns, const double* position_m) {
  write_header(out, time_ns, kInstrumentFrame);
  for (int i = 0; i < 3; ++i) out.number(position_m[i]);
}

void write_pose(CdrWriter& out, TimeNs time_ns, const ExportPose& pose) {
  write_header(out, time_ns, kInstrumentFrame);
  for (const double value : pose.position_m) out.number(value);
  write_quaternion(out, pose.orientation);
}

void write_value(CdrWriter& out, TimeNs time_ns, double value) {
  write_header(out, time_ns, "");
  out.number(value);
}

void write_log(CdrWriter& out, TimeNs time_ns, bool is_warning, std::string_view from,
               std::string_view text) {
  constexpr std::uint8_t kInfo = 20, kWarn = 30;
  out.begin();
  out.time(time_ns);
  out.number(is_warning ? kWarn : kInfo);
  out.text(from);
  out.text(text);
  out.text("");
  out.text("");
  out.number(std::uint32_t{0});
}

void write_estimate(CdrWriter& out, TimeNs time_ns, const EstimateRow& row) {
  write_header(out, time_ns, kInstrumentFrame);
  for (int axis = 0; axis < row.axis_count; ++axis) write_axis(out, row.axes[axis]);
  write_quantity(out, row.friction_Ns_m);
  write_quantity(out, row.mass_kg);
  const auto& impedance = row.impedance;
  out.text(row.has_impedance ? limit_name(impedance.friction_Ns_m.limit) : "");
  out.text(row.has_impedance ? limit_name(impedance.mass_kg.limit) : "");
  std::string events;
  append_events(events, row.events);
  out.text(events);
}

void TransformsWriter::begin(std::uint32_t count) {
  out_.begin();
  out_.number(count);
}

void TransformsWriter::add(TimeNs time_ns, std::string_view child, const ExportPose& pose) {
  out_.time(time_ns);
  out_.text(kInstrumentFrame);
  out_.text(child);
  for (const double value : pose.position_m) out_.number(value);
  write_quaternion(out_, pose.orientation);
}

}  // namespace condyle::host
