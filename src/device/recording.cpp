#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "device/make.h"
#include "device/recorded_path.h"
#include "palpate/core/error.h"

namespace palpate::device {
namespace {

/// Cells of a CSV line; none of ours is quoted.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const auto first = cell.find_first_not_of(" \t\r"), last = cell.find_last_not_of(" \t\r");
    out.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return out;
}

/// Where the numbers of a pose stand: a file of poses, or force.csv of an earlier run.
struct Layout {
  std::vector<std::string> names;   ///< time, position, rotation
  std::vector<std::size_t> column;  ///< of each
  bool switches = false;            ///< the last of them are the switches
};
const std::vector<std::string> kPoses = {"time_s", "px_m", "py_m", "pz_m", "qw", "qx", "qy", "qz"};
const std::vector<std::string> kForces = {"time_s",
                                          "handle_x_m",
                                          "handle_y_m",
                                          "handle_z_m",
                                          "handle_rotation_x_rad",
                                          "handle_rotation_y_rad",
                                          "handle_rotation_z_rad"};

Layout layout_of(const std::vector<std::string>& headers, const std::string& path) {
  const auto has = [&](const std::string& name) {
    return std::find(headers.begin(), headers.end(), name) != headers.end();
  };
  Layout out{has("handle_x_m") ? kForces : kPoses, {}, has("switches")};
  if (out.switches) out.names.emplace_back("switches");
  for (const std::string& name : out.names) {
    if (!has(name))
      fail(
          "{}:1: no column \"{}\"{}; a recording has time_s, px_m, py_m, pz_m, qw, qx, qy, qz, or is "
          "force.csv of a run",
          path, name, suggestion(name, headers));
    out.column.push_back(
        static_cast<std::size_t>(std::find(headers.begin(), headers.end(), name) - headers.begin()));
  }
  return out;
}

std::uint32_t switches_of(double value, const std::string& where) {
  const auto out = static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0));
  if (static_cast<double>(out) != value)
    fail("{}: switches = {} is no set of bits; bit i of a whole number is 1 where switch i is pressed", where,
         value);
  return out;
}

double number_of(const std::string& cell, const std::string& where) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (code != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    fail("{}: \"{}\" is not a finite number", where, cell);
  return value;
}

RecordedPose pose_of(const std::vector<double>& v, const Layout& layout, const std::string& where) {
  RecordedPose out{v[0], {Quat::Identity(), Vec3(v[1], v[2], v[3])}};
  if (layout.switches) out.switches = switches_of(v.back(), where);
  if (v.size() - layout.switches == kForces.size()) {
    out.pose.rotation = quaternion_of(Vec3(v[4], v[5], v[6]));
    return out;
  }
  const Quat q(v[4], v[5], v[6], v[7]);
  if (!(std::abs(q.norm() - 1.0) < 1e-3))
    fail("{}: column \"qw\": the quaternion's length is {:.6g}, not 1", where, q.norm());
  out.pose.rotation = q.normalized();
  return out;
}

class RecordingDevice : public Device {
 public:
  RecordingDevice(const DeviceSpec& spec, const std::string& file)
      : poses_(read_recording(file)), specification_(figures_of(spec).specification) {}
  DeviceSpecification specification() const override { return specification_; }
  std::function<HandleSample(double)> path() const override {
    return [poses = poses_](double t) { return sample_recording(poses, t); };
  }
  bool can_be_archived() const override { return true; }

 protected:
  HandleSample do_sample(double t) override { return sample_recording(poses_, t); }

 private:
  std::vector<RecordedPose> poses_;
  DeviceSpecification specification_;
};

}  // namespace

std::vector<RecordedPose> read_recording(const std::string& path) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path))
    fail("{}: no recording can be read; check the path (relative to the scene file)", path);
  std::string line;
  if (!std::getline(in, line)) fail("{}:1: the file is empty; its first line names the columns", path);
  const std::vector<std::string> headers = cells_of(line);
  const Layout layout = layout_of(headers, path);
  std::vector<RecordedPose> out;
  std::vector<double> values(layout.names.size());
  for (long number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty()) continue;
    const std::string where = fmt::format("{}:{}", path, number);
    if (cells.size() != headers.size())
      fail("{}: {} cells, but {} columns have a name", where, cells.size(), headers.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] =
          number_of(cells[layout.column[i]], fmt::format("{}: column \"{}\"", where, layout.names[i]));
    if (!out.empty() && !(values[0] > out.back().time))
      fail("{}: column \"time_s\": {} does not come after {}, the line before", where, values[0],
           out.back().time);
    out.push_back(pose_of(values, layout, where));
  }
  if (out.empty()) fail("{}: no line of poses follows the names of the columns", path);
  return out;
}

// Position: the cubic of Hermite between neighbours, x = s/T in [0, 1],
//     p = (2x^3 - 3x^2 + 1) p0 + (x^3 - 2x^2 + x) T v0 + (3x^2 - 2x^3) p1 + (x^3 - x^2) T v1,
// with the velocities of the parabola through a line and its two neighbours, v1 = (h0 d1 + h1 d0)/(h0 + h1)
// of the slopes d0, d1 over h0, h1; at the ends the slope of the only segment.  Rotation: about one fixed
// axis from line to line, R = exp(x d) R0, so its rate d/T is exact and jumps at the lines.
HandleSample sample_recording(const std::vector<RecordedPose>& poses, double t) {
  if (poses.empty()) fail("recording: no poses; give at least one");
  HandleSample out;
  if (!(t > poses.front().time) || t >= poses.back().time) {
    const RecordedPose& end = t >= poses.back().time ? poses.back() : poses.front();
    out.pose = end.pose;
    out.switches = end.switches;
    return out;
  }
  const auto to = std::upper_bound(poses.begin(), poses.end(), t,
                                   [](double time, const RecordedPose& one) { return time < one.time; });
  const std::size_t i = static_cast<std::size_t>(to - poses.begin()) - 1;
  out.switches = poses[i].switches;
  const auto slope = [&](std::size_t k) {
    return Vec3((poses[k + 1].pose.translation - poses[k].pose.translation) /
                (poses[k + 1].time - poses[k].time));
  };
  const auto velocity = [&](std::size_t k) {
    if (k == 0) return slope(0);
    if (k + 1 == poses.size()) return slope(k - 1);
    const double h0 = poses[k].time - poses[k - 1].time, h1 = poses[k + 1].time - poses[k].time;
    return Vec3((h0 * slope(k) + h1 * slope(k - 1)) / (h0 + h1));
  };
  const double T = poses[i + 1].time - poses[i].time, x = (t - poses[i].time) / T;
  const Vec3 p0 = poses[i].pose.translation, p1 = poses[i + 1].pose.translation, m0 = T * velocity(i),
             m1 = T * velocity(i + 1);
  out.pose.translation = p0 + x * (m0 + x * ((3.0 - 2.0 * x) * (p1 - p0) + (x - 2.0) * m0 + (x - 1.0) * m1));
  out.twist.linear =
      (6.0 * x * (1.0 - x) * (p1 - p0) + (1.0 - x) * (1.0 - 3.0 * x) * m0 + x * (3.0 * x - 2.0) * m1) / T;
  out.acceleration.linear =
      ((6.0 - 12.0 * x) * (p1 - p0) + (6.0 * x - 4.0) * m0 + (6.0 * x - 2.0) * m1) / (T * T);
  const Vec3 d = pose_difference(poses[i].pose, poses[i + 1].pose).head<3>();
  out.pose.rotation = quaternion_of(x * d) * poses[i].pose.rotation;
  out.twist.angular = d / T;
  return out;
}

std::unique_ptr<Device> make_recording(const DeviceSpec& spec, const std::string& folder) {
  if (spec.file.empty()) fail("device: file is missing; name the recording (CSV) that the hand repeats");
  return std::make_unique<RecordingDevice>(spec, (std::filesystem::path(folder) / spec.file).string());
}

}  // namespace palpate::device
