#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/csv.h"
#include "device/make.h"
#include "device/monotone_slope.h"
#include "device/recorded_path.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

/// Returns the column names in lower case, without the # that numpy writes before them.
std::vector<std::string> headers_of(const CsvRow& row) {
  std::vector<std::string> out = row.cells;
  std::string& first = out.front();
  first.erase(0, std::min(first.find_first_not_of("# "), first.size()));
  for (std::string& name : out)
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_blank(const CsvRow& row) {
  return std::all_of(row.cells.begin(), row.cells.end(),
                     [](const std::string& cell) { return cell.empty(); });
}

/// Columns of a pose: in a file of poses, or in force.csv of an earlier run.
struct Layout {
  std::vector<std::string> names;   ///< Time, position, rotation.
  std::vector<std::size_t> column;  ///< Column of each name.
  bool switches = false;            ///< The last name is the switches.
};
const std::vector<std::string> kPoses = {"time_s", "px_m", "py_m", "pz_m", "qw", "qx", "qy", "qz"};
const std::vector<std::string> kForces = {"time_s",
                                          "handle_x_m",
                                          "handle_y_m",
                                          "handle_z_m",
                                          "handle_rotation_x_rad",
                                          "handle_rotation_y_rad",
                                          "handle_rotation_z_rad"};

constexpr const char* kColumns =
    "a recording has the columns time_s, px_m, py_m, pz_m, qw, qx, qy, qz, or is force.csv of a run";

Layout layout_of(const std::vector<std::string>& headers, const std::string& path) {
  double number = 0.0;
  if (read_csv_number(headers.front(), number))
    fail("{}:1: the first line has numbers instead of column names; {}", path, kColumns);
  if (headers.size() == 1 && headers.front().find_first_of(" |:") != std::string::npos)
    fail("{}:1: the columns are not separated by commas, semicolons or tabs; use one of these", path);
  const auto has = [&](const std::string& name) {
    return std::find(headers.begin(), headers.end(), name) != headers.end();
  };
  Layout out{has("handle_x_m") ? kForces : kPoses, {}, has("switches")};
  if (out.switches) out.names.emplace_back("switches");
  for (const std::string& name : out.names) {
    if (!has(name)) fail("{}:1: no column \"{}\"{}; {}", path, name, suggestion(name, headers), kColumns);
    out.column.push_back(
        static_cast<std::size_t>(std::find(headers.begin(), headers.end(), name) - headers.begin()));
  }
  return out;
}

std::uint32_t switches_of(double value, const std::string& where) {
  const auto out = static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0));
  if (static_cast<double>(out) != value)
    fail("{}: switches = {} must be a whole number whose bit i is 1 if switch i is pressed", where, value);
  return out;
}

/// Reader for the numbers of one file, which has either decimal points or decimal commas.
class Numbers {
 public:
  double of(const std::string& cell, const std::string& where) {
    double value = 0.0;
    if (!read_csv_number(cell, value) || !std::isfinite(value))
      fail("{}: \"{}\" is not a finite number", where, cell);
    const std::size_t at = cell.find_first_of(".,");
    if (at == std::string::npos) return value;
    if (mark_ == '\0') mark_ = cell[at], seen_ = cell;
    if (mark_ != cell[at])
      fail("{}: \"{}\" has a decimal {}, but \"{}\" before it has a decimal {}; use the same for all numbers",
           where, cell, name(cell[at]), seen_, name(mark_));
    return value;
  }

 private:
  static const char* name(char mark) { return mark == ',' ? "comma" : "point"; }
  char mark_ = '\0';  ///< Decimal mark; '\0': none yet.
  std::string seen_;  ///< First number with it.
};

RecordedPose pose_of(const std::vector<double>& v, const Layout& layout, const std::string& where) {
  RecordedPose out{v[0], {Quat::Identity(), Vec3(v[1], v[2], v[3])}};
  if (layout.switches) out.switches = switches_of(v.back(), where);
  if (v.size() - layout.switches == kForces.size()) {
    out.pose.rotation = quaternion_of(Vec3(v[4], v[5], v[6]));
    return out;
  }
  const Quat q(v[4], v[5], v[6], v[7]);
  if (!(std::abs(q.norm() - 1.0) < 1e-3))
    fail("{}: column \"qw\": the length of the quaternion is {:.6g}; it must be 1", where, q.norm());
  out.pose.rotation = q.normalized();
  return out;
}

class RecordingDevice : public Device {
 public:
  RecordingDevice(const DeviceSpec& spec, const std::string& file)
      : poses_(read_recording(file, RecordingClock::of(spec))),
        specification_(figures_of(spec).specification) {}
  DeviceSpecification specification() const override { return specification_; }
  std::function<HandleSample(double)> path() const override {
    return [poses = poses_](double t) { return sample_recording(poses, t); };
  }
  std::optional<TimeSpan> recorded() const override {
    return TimeSpan{poses_.front().time, poses_.back().time};
  }
  bool can_be_archived() const override { return true; }

 protected:
  HandleSample do_sample(double t) override { return sample_recording(poses_, t); }

 private:
  std::vector<RecordedPose> poses_;
  DeviceSpecification specification_;
};

}  // namespace

std::vector<RecordedPose> read_recording(const std::string& path, const RecordingClock& clock) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path))
    fail("{}: cannot read the recording; check the path (relative to the scene file)", path);
  std::vector<CsvRow> rows = read_csv_text(std::string(std::istreambuf_iterator<char>(in), {}), path);
  std::erase_if(rows, is_blank);
  if (rows.empty()) fail("{}:1: the file is empty; its first line must be the column names", path);
  const std::vector<std::string> headers = headers_of(rows.front());
  const Layout layout = layout_of(headers, path);
  rows.erase(rows.begin());
  Numbers numbers;
  std::vector<RecordedPose> out;
  std::vector<double> values(layout.names.size());
  for (CsvRow& row : rows) {
    const std::string where = fmt::format("{}:{}", path, row.line);
    while (row.cells.size() > headers.size() && row.cells.back().empty()) row.cells.pop_back();
    if (row.cells.size() != headers.size())
      fail("{}: {} cells, but {} column names", where, row.cells.size(), headers.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] =
          numbers.of(row.cells[layout.column[i]], fmt::format("{}: column \"{}\"", where, layout.names[i]));
    values[0] = clock(values[0]);
    if (!out.empty() && !(values[0] > out.back().time))
      fail("{}: column \"time_s\": {} must be greater than {}, the time of the previous line", where,
           values[0], out.back().time);
    out.push_back(pose_of(values, layout, where));
  }
  if (out.empty()) fail("{}: no poses follow the column names", path);
  return out;
}

// Position: Hermite cubic between neighbouring lines, x = s/T in [0, 1],
//     p = (2x^3 - 3x^2 + 1) p0 + (x^3 - 2x^2 + x) T v0 + (3x^2 - 2x^3) p1 + (x^3 - x^2) T v1,
// with velocities from the parabola through a line and its two neighbours, v1 = (h0 d1 + h1 d0)/(h0 + h1) for
// slopes d0, d1 over h0, h1; at the ends the slope of the only segment. If such a velocity would carry a
// component beyond the two lines, as next to a pause, it is replaced by the nearest one that does not
// (monotone_slope). Rotation: about a fixed axis per segment, R = exp(x d) R0, so the rate d/T is exact and
// jumps at the lines.
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
    const Vec3 before = slope(k - 1), after = slope(k);
    return monotone_slope(monotone_slope((h0 * after + h1 * before) / (h0 + h1), before), after);
  };
  const double T = poses[i + 1].time - poses[i].time, x = (t - poses[i].time) / T;
  const Vec3 p0 = poses[i].pose.translation, p1 = poses[i + 1].pose.translation, m0 = T * velocity(i),
             m1 = T * velocity(i + 1);
  out.pose.translation = (p0 + x * (m0 + x * ((3.0 - 2.0 * x) * (p1 - p0) + (x - 2.0) * m0 + (x - 1.0) * m1)))
                             .cwiseMax(p0.cwiseMin(p1))  // limits rounding errors
                             .cwiseMin(p0.cwiseMax(p1));
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
  if (spec.file.empty()) fail("device: file is missing; set it to the recording (CSV) of the hand");
  return std::make_unique<RecordingDevice>(spec, (std::filesystem::path(folder) / spec.file).string());
}

}  // namespace palpate::device
