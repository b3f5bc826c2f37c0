// A rigid sphere of radius r and a ball of radius R meet in a circle of radius a if the distance of their
// centres is
//     sqrt(r^2 - a^2) + sqrt(R^2 - a^2),
// which keeps the radius of the contact region for any R. With R proportional to the square root of the
// number of vertices the skin's triangles keep their size as well: the query processes the same region under
// the same triangles, on a skin that is larger elsewhere.
#include <algorithm>
#include <cmath>

#include "contact/sources.h"
#include "core/clock.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/state.h"
#include "palpate/mesh/generators.h"
#include "product/contact.h"
#include "product/contact/statistics.h"
#include "product/fem.h"

namespace palpate::bench {
namespace {

constexpr double kEdge = 0.01;           ///< Edge of the skin's triangles [m].
constexpr int kCells = 11;               ///< Elements along the radius: about 10,000 tetrahedra.
constexpr double kRegion = 0.05;         ///< a of the smallest region [m].
constexpr double kToolOverRegion = 4.0;  ///< r/a: the same slope at the rim of every region.
constexpr int kToolSubdivisions = 48;
constexpr int kQueries = 24, kUntimed = 4;

/// Frame placed by each query.
class PutFrame final : public contact::MovingFrame {
 public:
  Pose pose(const dynamics::StateView&) const override { return at; }
  Twist twist(const dynamics::StateView&) const override { return {}; }
  Pose at;
};

LayeredModel ball_of(int skin_vertices) {
  const int subdivisions = std::max(4, static_cast<int>(std::lround(std::sqrt(skin_vertices / 10.0))));
  // An icosahedron's edge is 1.05 times its radius; subdivided and projected onto the sphere, 1.1 on average.
  const double radius = kEdge * subdivisions / 1.1;
  LayeredModel model;
  model.name = "ball";
  model.tets = mesh::ball(radius, radius / kCells);
  model.skin = mesh::sphere(radius, subdivisions);
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  return model;
}

/// Ball as a block of a State and one side of a contact.
struct Touched {
  LayeredModel model;
  double radius;
  dynamics::State state;
  int block;

  explicit Touched(int skin_vertices)
      : model(ball_of(skin_vertices)), radius(model.skin.vertices.col(0).norm()) {
    const VecX q = model.tets.nodes.reshaped();
    const int size = static_cast<int>(q.size());
    block = state.insert({.name = "ball", .q_size = size, .u_size = size}, q, VecX::Zero(size));
  }
  contact::NodeSurface surface() const {
    return {block, {}, model.skin.faces, model.embedding, model.tets.tets};
  }
};

/// Direction in which the tool's sphere meets the ball: no node of the icosahedron, and not along an axis.
const Vec3 kWhere = Vec3(0.36, 0.48, 0.8);

ContactGrowthRow touch(Touched& ball, double region) {
  const double r = kToolOverRegion * region, R = ball.radius,
               apart = std::sqrt(r * r - region * region) + std::sqrt(R * R - region * region);
  TriMesh tool = mesh::sphere(r, kToolSubdivisions);
  contact::ContactForce contact;
  const auto frame = std::make_shared<PutFrame>();
  const int at = contact.add_frame(frame);
  contact.add_pair(contact::make_distance_source(ball.surface(), ball.model.skin.vertices,
                                                 contact::FrameSurface{std::move(tool), at, frame},
                                                 {.candidate_gap = kEdge}),
                   {.first = "ball", .second = "tool"});
  ContactGrowthRow out;
  out.skin_vertices = static_cast<int>(ball.model.skin.vertices.cols());
  VecX force;
  std::vector<double> ms, areas, samples;
  for (int k = 0; k < kUntimed + kQueries; ++k) {
    // The tool moves around by about an edge: no two queries find the same nearest points.
    const double angle = 2.0 * M_PI * k / kQueries;
    const Vec3 aside = kEdge * (std::cos(angle) * Vec3(0.8, -0.6, 0.0) + std::sin(angle) * Vec3(0, 0, 1));
    frame->at.translation = apart * (R * kWhere + aside).normalized();
    const dynamics::StateView state = ball.state.view();
    const double start = wall_seconds();
    contact.refresh(state);
    force.setZero(state.u.size());
    contact.add_force(state, force);
    const double took = 1e3 * (wall_seconds() - start);
    if (k < kUntimed) continue;
    ms.push_back(took);
    double area = 0.0;
    for (const contact::ContactSample& s : contact.samples())
      if (s.gap < 0.0) area += s.area;
    areas.push_back(area);
    samples.push_back(static_cast<double>(contact.samples().size()));
  }
  out.query = spread_of(ms);
  out.area_m2 = median(areas);
  out.samples = static_cast<long>(median(samples));
  return out;
}

bool stopped(const std::atomic<bool>* stop) { return stop && *stop; }

}  // namespace

std::vector<ContactGrowthRow> bench_skin_growth(const std::vector<int>& skin_vertices,
                                                const std::atomic<bool>* stop) {
  std::vector<ContactGrowthRow> out;
  for (const int vertices : skin_vertices) {
    if (stopped(stop)) break;
    Touched ball(vertices);
    out.push_back(touch(ball, kRegion));
  }
  return out;
}

std::vector<ContactGrowthRow> bench_patch_growth(int skin_vertices, double factor, int count,
                                                 const std::atomic<bool>* stop) {
  if (!(factor > 1.0) || count < 2)
    fail(
        "bench contact: the region grows by a factor of {} in {} steps; use a factor above 1 and at least 2 "
        "steps",
        factor, count);
  std::vector<ContactGrowthRow> out;
  Touched ball(skin_vertices);
  for (int k = 0; k < count && !stopped(stop); ++k)
    out.push_back(touch(ball, kRegion * std::pow(factor, 0.5 * k / (count - 1))));
  return out;
}

double ContactGrowth::exponent() const {
  std::vector<std::pair<double, double>> points;
  for (const ContactGrowthRow& r : rows)
    points.emplace_back(with == "area" ? r.area_m2 : static_cast<double>(r.skin_vertices), r.query.median);
  return scaling_exponent(points);
}

}  // namespace palpate::bench
