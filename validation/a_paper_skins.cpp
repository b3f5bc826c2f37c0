#include <algorithm>
#include <cmath>
#include <map>

#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/layered_model.h"
#include "palpate/proxy/decompose.h"
#include "palpate/proxy/proxy_set.h"
#include "palpate/shapes/shapes.h"

// The skins of the paper's objects, bent: two pumpkins pressed together, two gears in mesh, a head under a
// ball.  The reference is a line along the contact's normal through a pixel's middle, cut with every triangle
// of both skins in double.  By the winding of its crossings the line is inside of a in some intervals and
// inside of b in others.  Where the union of both is one piece and the two have something in common, the
// overlap's depth is from the lowest entry into a to the highest exit out of b of that piece: along +n, which
// pushes a up, that is how far they have to part.  Teeth beside each other are pieces of their own.
//
// Nothing of the library's own lines or images is in the reference.

namespace palpate::validation {
namespace {

/// A skin in a box of tetrahedra, which carries it.
LayeredModel model_of(const std::string& name, int vertices) {
  LayeredModel out;
  out.name = name;
  out.skin = shapes::make(name, {.skin_vertices = vertices, .base_vertices = 0}).skin;
  const Vec3 low = out.skin.vertices.rowwise().minCoeff(), high = out.skin.vertices.rowwise().maxCoeff();
  out.tets = mesh::box(1.1 * (high - low), {6, 6, 6});
  out.tets.nodes.colwise() += 0.5 * (low + high);
  out.embedding = mesh::embed(out.tets, out.skin.vertices);
  out.proxies = proxy::decompose(out, {.count = 40});
  return out;
}

/// Placed and bent: by `bend` of its size, smoothly.
struct Body {
  LayeredModel model;
  Points nodes;
  TriMesh skin;  ///< as it is now

  Body(const LayeredModel& m, const Pose& pose, double bend) : model(m), nodes(m.tets.nodes) {
    const double size = (m.skin.vertices.rowwise().maxCoeff() - m.skin.vertices.rowwise().minCoeff()).norm();
    for (auto x : nodes.colwise()) {
      const Vec3 p = x / size;
      x = pose * Vec3(x + bend * size * Vec3(p.y() * p.z(), p.x() * p.z(), p.x() * p.x() - p.y() * p.y()));
    }
    skin.faces = m.skin.faces;
    mesh::evaluate(m.embedding, m.tets.tets, nodes, skin.vertices);
  }
};

struct State {
  std::string name;
  LayeredModel first;
  Pose first_pose;
  LayeredModel second;
  Pose second_pose;
  double bend = 0.0, size = 0.0;  ///< R [m]
};

struct Pair {
  dynamics::State state;
  Body a, b;
  contact::NodeSurface of_a, of_b;
  std::shared_ptr<proxy::ProxySet> proxies_a, proxies_b;

  explicit Pair(const State& s)
      : a(s.first, s.first_pose, s.bend),
        b(s.second, s.second_pose, -s.bend),
        of_a(add(a)),
        of_b(add(b)),
        proxies_a(std::make_shared<proxy::ProxySet>(a.model)),
        proxies_b(std::make_shared<proxy::ProxySet>(b.model)) {}
  contact::NodeSurface add(const Body& body) {
    dynamics::BlockSpec block;
    block.name = body.model.name;
    block.q_size = block.u_size = static_cast<int>(body.nodes.size());
    return {state.insert(block, body.nodes.reshaped(), VecX::Zero(body.nodes.size())),
            {},
            body.model.skin.faces,
            body.model.embedding,
            body.model.tets.tets};
  }
  std::unique_ptr<contact::SampleSource> source(contact::DepthBackend backend, bool pruned,
                                                contact::SampleRule rule, double gap) const {
    contact::ImageOptions options;
    options.backend = backend;
    options.pixels = 256;
    options.quadrature_error = 0.0;
    options.samples = rule;
    options.candidate_gap = gap;
    return pruned ? contact::make_image_source(of_a, proxies_a, of_b, proxies_b, options)
                  : contact::make_image_source(of_a, of_b, options);
  }
};

Vec3 point(const contact::SurfacePoint& p, const dynamics::StateView& state) {
  Vec3 x = p.offset;
  for (int k = 0; k < p.count; ++k)
    x += p.weight[static_cast<std::size_t>(k)] * state.position(p.node[static_cast<std::size_t>(k)]);
  return x;
}

/// Where the samples of one image stand: column and row of each.
struct Grid {
  Mat3 axes;  ///< columns u, v, n
  Vec3 origin;
  double pixel;
  Eigen::Vector2i cell(const Vec3& x) const {
    const Vec3 at = axes.transpose() * (x - origin) / pixel;
    return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
  }
};

using Field =
    std::map<std::pair<int, int>, std::vector<double>>;  ///< depths > 0 by row and column, ascending

Field field_of(const std::vector<contact::ContactSample>& samples, const dynamics::StateView& state,
               const Grid& grid) {
  Field out;
  for (const auto& s : samples)
    if (s.gap < 0.0) {
      const Eigen::Vector2i cell = grid.cell(point(s.b, state));
      out[{cell.y(), cell.x()}].push_back(-s.gap);
    }
  for (auto& [cell, depths] : out) std::sort(depths.begin(), depths.end());
  return out;
}

/// Heights above the grid's plane where a line along n crosses a skin, and whether it enters.
struct Crossing {
  double w;
  bool enters, of_a;
};

/// Cuts lines with all triangles of a skin.  @param lines  (column, row) of each
void cut(const TriMesh& skin, bool of_a, const Grid& grid, const std::vector<Eigen::Vector2i>& lines,
         std::vector<std::vector<Crossing>>& out) {
  const Points x = grid.axes.transpose() * (skin.vertices.colwise() - grid.origin);
  for (const auto& face : skin.faces.colwise()) {
    const Vec3 p = x.col(face[0]), q = x.col(face[1]), r = x.col(face[2]);
    const Vec3 low = p.cwiseMin(q).cwiseMin(r), high = p.cwiseMax(q).cwiseMax(r);
    const auto cross = [](const Vec3& o, const Vec3& s, double u, double v) {
      return (s.x() - o.x()) * (v - o.y()) - (s.y() - o.y()) * (u - o.x());
    };
    const double area = cross(p, q, r.x(), r.y());
    if (area == 0.0) continue;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double u = lines[i].x() * grid.pixel, v = lines[i].y() * grid.pixel;
      if (u < low.x() || u > high.x() || v < low.y() || v > high.y()) continue;
      const double wp = cross(q, r, u, v) / area, wq = cross(r, p, u, v) / area, wr = 1.0 - wp - wq;
      if (std::min({wp, wq, wr}) < 0.0) continue;
      out[i].push_back({wp * p.z() + wq * q.z() + wr * r.z(), area < 0.0, of_a});
    }
  }
}

/// Depths of the overlaps on a line: see above.
std::vector<double> depths_of(std::vector<Crossing> line) {
  std::sort(line.begin(), line.end(), [](const Crossing& s, const Crossing& t) { return s.w < t.w; });
  std::vector<double> out;
  int in_a = 0, in_b = 0;
  double lowest_a = std::nan(""), highest_b = std::nan("");
  bool both = false;
  for (const Crossing& at : line) {
    (at.of_a ? in_a : in_b) += at.enters ? 1 : -1;
    if (at.of_a && at.enters && std::isnan(lowest_a)) lowest_a = at.w;
    if (!at.of_a && !at.enters) highest_b = at.w;
    both |= in_a > 0 && in_b > 0;
    if (in_a > 0 || in_b > 0) continue;
    if (both && highest_b > lowest_a) out.push_back(highest_b - lowest_a);
    lowest_a = highest_b = std::nan("");
    both = false;
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// How two fields differ, but for cells at the border of either.
struct Difference {
  double largest = 0.0;  ///< [m]
  long compared = 0, other = 0;
};
bool is_inner(const Field& field, std::pair<int, int> cell) {
  for (int v = -1; v <= 1; ++v)
    for (int u = -1; u <= 1; ++u)
      if (!field.contains({cell.first + v, cell.second + u})) return false;
  return true;
}
void compare(const std::vector<double>& truth, const std::vector<double>& seen, Difference& out) {
  if (truth.size() != seen.size()) {
    ++out.other;
    return;
  }
  for (std::size_t i = 0; i < truth.size(); ++i)
    out.largest = std::max(out.largest, std::abs(truth[i] - seen[i]));
  ++out.compared;
}

Grid grid_of(const std::vector<contact::ContactSample>& samples, const dynamics::StateView& state) {
  Grid grid;
  const Vec3 n = samples.front().normal;
  grid.axes.col(2) = n;
  // as the library lays its axes
  grid.axes.col(0) = Vec3(std::abs(n.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY()).cross(n).normalized();
  grid.axes.col(1) = n.cross(grid.axes.col(0));
  grid.pixel = std::sqrt(samples.front().area);
  grid.origin = point(samples.front().b, state);
  return grid;
}

std::vector<contact::ContactSample> samples_of(const Pair& pair, contact::DepthBackend backend, bool pruned,
                                               contact::SampleRule rule, double gap) {
  std::vector<contact::ContactSample> out;
  pair.source(backend, pruned, rule, gap)->query(pair.state.view(), out);
  return out;
}

/// A field against lines through every kStride-th pixel, away from the border.
Difference against_lines(const Field& field, const Grid& grid, const Pair& pair) {
  constexpr int kStride = 5;
  std::vector<Eigen::Vector2i> lines;
  Eigen::Vector2i low(1 << 30, 1 << 30), high(-(1 << 30), -(1 << 30));
  for (const auto& [cell, depths] : field) {
    low = low.cwiseMin(Eigen::Vector2i(cell.second, cell.first));
    high = high.cwiseMax(Eigen::Vector2i(cell.second, cell.first));
  }
  for (int v = low.y() - 2; v <= high.y() + 2; v += kStride)
    for (int u = low.x() - 2; u <= high.x() + 2; u += kStride) lines.emplace_back(u, v);
  std::vector<std::vector<Crossing>> crossings(lines.size());
  cut(pair.a.skin, true, grid, lines, crossings);
  cut(pair.b.skin, false, grid, lines, crossings);
  Difference out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::pair<int, int> cell{lines[i].y(), lines[i].x()};
    const std::vector<double> truth = depths_of(crossings[i]);
    const auto seen = field.find(cell);
    if (truth.empty() && seen == field.end()) continue;
    if (!is_inner(field, cell) && seen != field.end() && seen->second.size() != truth.size()) continue;
    if (seen == field.end()) {
      // shallower than what the border rises over a pixel
      out.other += truth.size() > 1 || truth[0] > grid.pixel;
      continue;
    }
    compare(truth, seen->second, out);
  }
  return out;
}

Vec3 force_of(const std::vector<contact::ContactSample>& samples) {
  Vec3 sum = Vec3::Zero();
  for (const auto& s : samples)
    if (s.gap < 0.0) sum -= s.gap * s.area * s.normal;
  return sum;
}

std::vector<State> states() {
  std::vector<State> out;
  const LayeredModel pumpkin = model_of("pumpkin", 6000), gear = model_of("gear", 8000),
                     head = model_of("head", 12000);
  LayeredModel ball = model_of("ball", 3000);
  const auto size = [](const LayeredModel& m) {
    return Vec3(m.skin.vertices.rowwise().maxCoeff() - m.skin.vertices.rowwise().minCoeff());
  };
  const auto radius = [&](const LayeredModel& m) { return 0.5 * size(m).maxCoeff(); };
  fmt::print(
      stderr,
      "sizes: pumpkin {:.3f} {:.3f} {:.3f} gear {:.3f} {:.3f} {:.3f} head {:.3f} {:.3f} {:.3f} ball {:.3f}\n",
      size(pumpkin).x(), size(pumpkin).y(), size(pumpkin).z(), size(gear).x(), size(gear).y(), size(gear).z(),
      size(head).x(), size(head).y(), size(head).z(), size(ball).x());
  out.push_back({"pumpkins",
                 pumpkin,
                 {},
                 pumpkin,
                 {quaternion_of(Vec3(0.2, 0.1, 0.7)), Vec3(0.97 * size(pumpkin).x(), 0.004, 0.003)},
                 0.05,
                 radius(pumpkin)});
  for (const double turn : {0.02, 0.05, 0.1})
    out.push_back({fmt::format("gears, turned by {} rad", turn),
                   gear,
                   {quaternion_of(Vec3(0, 0, turn)), Vec3::Zero()},
                   gear,
                   {Quat::Identity(), Vec3(0.094, 0, 0)},
                   0.01,
                   radius(gear)});
  out.push_back(
      {"head under a ball",
       head,
       {},
       ball,
       {Quat::Identity(), Vec3(0.005, -0.5 * size(head).y() - radius(ball) + 0.1 * radius(ball), 0.01)},
       0.05,
       radius(head)});
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const State& state : states()) {
    const Pair pair(state);
    const double gap = 1e-3 * state.size;
    for (const bool pruned : {false, true}) {
      std::vector<contact::ContactSample> exact;
      Field lines;
      for (const contact::DepthBackend backend :
           {contact::DepthBackend::kExact, contact::DepthBackend::kCpu, contact::DepthBackend::kGpu}) {
        const auto samples = samples_of(pair, backend, pruned, contact::SampleRule::kPixel, gap);
        if (samples.empty()) {
          fmt::print(stderr, "{}: nothing\n", state.name);
          break;
        }
        if (backend == contact::DepthBackend::kExact) exact = samples;
        const Grid grid = grid_of(exact, pair.state.view());
        const Field field = field_of(samples, pair.state.view(), grid);
        Difference d, e;
        if (!pruned) d = against_lines(field, grid, pair);
        if (backend == contact::DepthBackend::kExact) lines = field;
        long only = 0;
        for (const auto& [cell, depths] : lines)
          if (const auto at = field.find(cell); at == field.end())
            ++only;
          else
            compare(depths, at->second, e);
        fmt::print(stderr,
                   "{} pruned {} {}: {} samples; lines: largest {:.1e} R compared {} other {}; exact: {:.1e} "
                   "R compared {} other {} only {}; force {:.3e}, off exact {:.1e}\n",
                   state.name, pruned, contact::backend_name(backend), samples.size(), d.largest / state.size,
                   d.compared, d.other, e.largest / state.size, e.compared, e.other, only,
                   force_of(samples).norm(),
                   (force_of(samples) - force_of(exact)).norm() / force_of(exact).norm());
      }
      for (const contact::DepthBackend backend :
           {contact::DepthBackend::kExact, contact::DepthBackend::kCpu, contact::DepthBackend::kGpu}) {
        const auto samples = samples_of(pair, backend, pruned, contact::SampleRule::kVertex, gap);
        fmt::print(stderr, "  vertices {}: {} force {:.6e}\n", contact::backend_name(backend), samples.size(),
                   force_of(samples).norm());
      }
    }
  }
  return out;
}

}  // namespace

ValidationCase paper_skins() {
  return {.name = "paper-skins",
          .section = "A",
          .summary = "",
          .why = "",
          .run = run,
          .faults = {},
          .slow = true};
}

}  // namespace palpate::validation
