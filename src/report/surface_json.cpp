#include "surface_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/markup.h"
#include "core/object_colours.h"
#include "core/rigid_fit.h"
#include "core/rounded_range.h"
#include "decimate.h"
#include "json.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"

namespace palpate::report {
namespace {

constexpr int kLeastVertices = 64;  // per part
constexpr double kLevels = 65535.0;

/// Part as shown: its points of the run, and the faces between them.
struct Shown {
  std::string name, colour;
  bool body = false;
  std::size_t part = 0;            ///< Index among the parts of the run
  std::vector<Pose> motions = {};  ///< Rigid motion of a free body, step by step
  std::vector<int> points = {};
  Faces faces = {};
  int first = 0;  ///< Index of its first point among all points shown
  int count() const { return static_cast<int>(points.size()); }
};

int part_points(const store::RunPart& part) { return static_cast<int>(part.reference.cols()); }

Shown shown_of(const store::RunPart& part, int first_point, int most) {
  Shown out;
  out.name = part.name;
  out.body = part.tets.cols() > 0;
  out.faces = part.faces;
  Points vertices = part.reference;
  std::vector<int> node_of_vertex;
  if (out.body) {
    const mesh::Boundary outer = mesh::boundary({part.reference, part.tets});
    vertices = outer.surface.vertices;
    out.faces = outer.surface.faces;
    node_of_vertex = outer.node_of_vertex;
  }
  const CoarseSurface coarse = decimate(vertices, out.faces, most);
  out.faces = coarse.faces;
  for (const int v : coarse.kept)
    out.points.push_back(first_point + (out.body ? node_of_vertex[static_cast<std::size_t>(v)] : v));
  return out;
}

/// Returns the colour of a part without tetrahedra.
/// @param before  number of such parts before it
std::string_view rigid_colour(const std::string& name, std::size_t before,
                              const std::vector<std::string>& tools) {
  if (tools.empty()) return colours::tool(before);
  const auto found = std::find(tools.begin(), tools.end(), name);
  return found == tools.end() ? colours::kBone
                              : colours::tool(static_cast<std::size_t>(found - tools.begin()));
}

std::vector<Shown> shown_parts(const store::RunReader& run, int most, const std::vector<std::string>& tools) {
  std::vector<Shown> out;
  std::size_t rigid = 0;
  const double share = std::min(1.0, static_cast<double>(most) / std::max(1, run.point_count()));
  for (std::size_t i = 0; i < run.parts().size(); ++i) {
    const store::RunPart& part = run.parts()[i];
    if (part.tets.cols() == 0 && part.faces.cols() == 0) continue;
    // points inside a body are not shown: the share of a part exceeds its need
    const int own = std::max(kLeastVertices, static_cast<int>(share * part_points(part)));
    const int first = out.empty() ? 0 : out.back().first + out.back().count();
    out.push_back(shown_of(part, run.first_point(static_cast<int>(i)), own));
    out.back().first = first;
    out.back().part = i;
    out.back().colour = out.back().body ? colours::kBody : rigid_colour(part.name, rigid++, tools);
  }
  return out;
}

/// Returns the points shown, from all points of the run.
Points gathered(const Points& all, const std::vector<Shown>& parts) {
  Points out(3, parts.empty() ? 0 : parts.back().first + parts.back().count());
  for (const Shown& part : parts)
    for (int i = 0; i < part.count(); ++i)
      out.col(part.first + i) = all.col(part.points[static_cast<std::size_t>(i)]);
  return out;
}

/// Returns the steps shown: evenly spaced, the last one included.
std::vector<int> shown_steps(int steps, long most) {
  const long count = std::clamp<long>(most, 1, steps);
  std::vector<int> out;
  for (long i = 0; i < count; ++i)
    out.push_back(count == 1 ? steps - 1 : static_cast<int>(i * (steps - 1) / (count - 1)));
  return out;
}

Points rest_of(const store::RunReader& run) {
  Points out(3, run.point_count());
  for (std::size_t i = 0; i < run.parts().size(); ++i)
    out.middleCols(run.first_point(static_cast<int>(i)), part_points(run.parts()[i])) =
        run.parts()[i].reference;
  return out;
}

void append_16(std::string& bytes, int value) {
  bytes += static_cast<char>(value & 0xFF);
  bytes += static_cast<char>(value >> 8 & 0xFF);
}

/// Bounding box of all points shown.
struct Box {
  Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
  void add(const Points& points) {
    low = low.cwiseMin(points.rowwise().minCoeff());
    high = high.cwiseMax(points.rowwise().maxCoeff());
  }
  std::string quantised(const Points& points, const Shown& part) const {
    std::string bytes;
    for (int p = part.first; p < part.first + part.count(); ++p)
      for (int k = 0; k < 3; ++k) {
        const double extent = high[k] - low[k], at = extent > 0.0 ? (points(k, p) - low[k]) / extent : 0.0;
        append_16(bytes, static_cast<int>(std::lround(kLevels * std::clamp(at, 0.0, 1.0))));
      }
    return bytes;
  }
};

/// Returns the volume around each node [m^3], a quarter of each of its tetrahedra: masses of a uniform body.
VecX nodal_volumes(const store::RunPart& part) {
  VecX out = VecX::Zero(part.reference.cols());
  for (const auto tet : part.tets.colwise()) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = part.reference.col(tet[k + 1]) - part.reference.col(tet[0]);
    for (const int node : tet) out[node] += std::abs(edges.determinant()) / 24.0;
  }
  return out;
}

/// Adds to each free body its rigid motion at a step.
/// @param all  all points of the run
void add_motions(const store::RunReader& run, const Points& all, std::vector<Shown>& parts,
                 const std::vector<std::string>& free_bodies) {
  for (Shown& part : parts) {
    if (!part.body || std::find(free_bodies.begin(), free_bodies.end(), part.name) == free_bodies.end())
      continue;
    const store::RunPart& of_run = run.parts()[part.part];
    const Points now = all.middleCols(run.first_point(static_cast<int>(part.part)), part_points(of_run));
    part.motions.push_back(rigid_fit(of_run.reference, now, nodal_volumes(of_run)));
  }
}

/// Returns the largest displacement of a body [m] at the newest step, without the rigid motion of free ones.
double most_displacement(const Points& points, const Points& rest, const std::vector<Shown>& parts) {
  double most = 0.0;
  for (const Shown& part : parts) {
    if (!part.body) continue;
    const Pose motion = part.motions.empty() ? Pose{} : part.motions.back();
    const Mat3 rotation = motion.rotation.toRotationMatrix();
    for (int p = part.first; p < part.first + part.count(); ++p)
      most = std::max(most, (points.col(p) - rotation * rest.col(p) - motion.translation).norm());
  }
  return most;
}

Json vector_json(const Vec3& v) { return {v[0], v[1], v[2]}; }

Json motions_json(const std::vector<Pose>& motions) {
  Json out = Json::array();
  for (const Pose& motion : motions) {
    Json one = Json::array();
    const Mat3 rotation = motion.rotation.toRotationMatrix();
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) one.push_back(rotation(i, k));
    for (const double x : motion.translation) one.push_back(x);
    out.push_back(one);
  }
  return out;
}

Json parts_json(const std::vector<Shown>& parts, const Box& box, const Points& rest,
                const std::vector<Points>& positions) {
  Json out = Json::array();
  for (const Shown& part : parts) {
    std::string faces, all;
    for (Eigen::Index f = 0; f < part.faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) append_16(faces, part.faces(k, f));
    for (const Points& now : positions) all += box.quantised(now, part);
    out.push_back({{"name", part.name},
                   {"kind", part.body ? "body" : "tool"},
                   {"colour", part.colour},
                   {"vertices", part.count()},
                   {"faces", base64(faces)},
                   {"rest", base64(box.quantised(rest, part))},
                   {"positions", base64(all)}});
    if (!part.motions.empty()) out.back()["motions"] = motions_json(part.motions);
  }
  return out;
}

/// Returns the first step at or after a time, up to rounding; the last step if all are earlier.
std::size_t first_from(const std::vector<double>& times, double time) {
  const double rounding = 1e-9 * std::abs(time);
  const auto at = std::find_if(times.begin(), times.end(), [&](double t) { return t >= time - rounding; });
  return static_cast<std::size_t>(std::min(at, times.end() - 1) - times.begin());
}

}  // namespace

std::string surface_json(const store::RunReader& run, const ViewBudget& budget,
                         const ViewSettings& settings) {
  std::vector<Shown> parts = shown_parts(run, budget.vertices, settings.tools);
  const long vertices = parts.empty() ? 0 : parts.back().first + parts.back().count();
  if (vertices == 0 || run.steps() == 0) return "";
  const std::vector<int> steps =
      shown_steps(run.steps(), std::min<long>(budget.steps, budget.position_bytes / (6 * vertices)));

  const Points rest = gathered(rest_of(run), parts);
  std::vector<Points> positions;
  std::vector<double> times;
  Box box;
  box.add(rest);
  double most = 0.0;
  std::size_t first_shown = 0;
  for (const int step : steps) {
    const Points all = run.points(step);
    Points now = gathered(all, parts);
    if (!all.allFinite()) break;
    add_motions(run, all, parts, settings.free_bodies);
    box.add(now);
    if (const double own = most_displacement(now, rest, parts); own > most)
      most = own, first_shown = positions.size();
    times.push_back(run.times_s()[static_cast<std::size_t>(step)]);
    positions.push_back(std::move(now));
  }
  if (positions.empty()) return "";
  if (std::isfinite(settings.shown_at_s)) first_shown = first_from(times, settings.shown_at_s);
  const Json target = settings.target_m ? vector_json(*settings.target_m) : Json(nullptr);
  return Json{{"times_s", times},
              {"low_m", vector_json(box.low)},
              {"high_m", vector_json(box.high)},
              {"most_displacement_m", rounded_range(most)},
              {"first_shown", first_shown},
              {"ramp", colours::kRamp},
              {"from", vector_json(settings.from)},
              {"up", vector_json(settings.up)},
              {"target_m", target},
              {"zoom", settings.zoom},
              {"parts", parts_json(parts, box, rest, positions)}}
      .dump();
}

}  // namespace palpate::report
