#include <cmath>

#include "throw.h"

// A slab of 5 mm, E = 1e6 Pa, at up to three times its wave speed. Its energy is bounded as in throw.cpp.
// - On a plane: everything behind it is inside, so no vertex can be missed.
// - On a rigid plate of the same thickness, k = 1e7 Pa/m: a vertex above it at one query and below it at
//   the next was never found inside, and the contact must have counted it as tunnelled. At 100 m/s a period
//   is 200 mm long; the spring alone would stop the slab after v sqrt(m/(k A)) = 70 mm and eject it from the
//   half-space that represents the plate within 2.2 ms: after one period of 2 ms it has passed through. (At
//   10 m/s the spring needs 7 mm: deeper than the thickness of the plate, so the slab may leave below, and
//   need not turn.) The count is computed here again from the nodes' positions alone (a plate wider than any
//   motion is crossed exactly where z changes from above to below or back), and must equal the contact's
//   count at every query.

namespace palpate::stability {
namespace {

constexpr double kThickness = 5e-3, kHalfWidth = 500.0;

scene::Description thin_slab() {
  scene::Description d = soft_cube();
  d.name = "thin slab";
  d.bodies[0].name = "slab";
  d.bodies[0].mesh.size_m = Vec3(0.1, 0.1, kThickness);
  d.bodies[0].mesh.element_size_m = 0.05;
  d.bodies[0].position_m = Vec3(0, 0, 0.5 * kThickness);
  d.bodies[0].youngs_modulus_pa = 1e6;
  return d;
}

ObstacleSpec thin_plate() {
  ObstacleSpec plate;
  plate.name = "plate";
  plate.type = "box";
  plate.shape["size_m"] = Vec3(2.0 * kHalfWidth, 2.0 * kHalfWidth, kThickness);
  plate.shape["position_m"] = Vec3(0, 0, -0.5 * kThickness);
  return plate;
}

/// Counts vertices that crossed the plate between two probes, which are at the times of the queries.
class Crossings {
 public:
  void probe(const loop::World& world) {
    if (!misses_.empty()) return;
    // Up to the last query, one probe ago.
    if (const auto pairs = world.contact->pairs(); !pairs.empty()) reported_ = pairs[0].tunnelled;
    if (reported_ != counted_)
      misses_ = fmt::format("{} vertices tunnelled through the plate, {} were reported", counted_, reported_);
    const loop::Body& slab = world.bodies[0];
    const Points x = world.positions(slab);
    // An explicit method that is about to overflow.
    if (x.cwiseAbs().maxCoeff() > 0.5 * kHalfWidth) gone_ = true;
    if (gone_) return;
    Points now(3, slab.boundary.surface.vertices.cols());
    for (Eigen::Index v = 0; v < now.cols(); ++v)
      now.col(v) = x.col(slab.boundary.node_of_vertex[static_cast<std::size_t>(v)]);
    for (Eigen::Index v = 0; v < before_.cols(); ++v)
      if (side(now(2, v)) * side(before_(2, v)) < 0) ++counted_;
    before_ = now;
  }
  bool gone() const { return gone_; }
  long counted() const { return counted_; }
  const std::string& misses() const { return misses_; }

 private:
  static int side(double z) { return z > 0.0 ? 1 : z < -kThickness ? -1 : 0; }
  Points before_;
  long counted_ = 0, reported_ = 0;
  bool gone_ = false;
  std::string misses_;
};

scene::Description on_plane(double speed) { return thrown_at(thin_slab(), floor_plane(), speed, 1e9); }
scene::Description on_plate(double speed) { return thrown_at(thin_slab(), thin_plate(), speed, 1e7); }

StabilityCell run_on_plane(const CaseContext& context, const scene::Description& d) {
  return projectile_case(context, d);
}

/// Returns whether the spring alone needs more than the plate's thickness to stop the slab.
bool goes_through(const scene::Description& d) {
  const double mass_over_area = d.bodies[0].density_kg_m3 * kThickness;
  return d.bodies[0].velocity_m_s.norm() * std::sqrt(mass_over_area / d.contacts[0].stiffness_pa_m) >
         kThickness;
}

StabilityCell run_on_plate(const CaseContext& context, const scene::Description& d) {
  Crossings crossings;
  StabilityCell cell = projectile_case(
      context, d,
      [&](loop::World& world, double) {
        if (!crossings.gone()) crossings.probe(world);
      },
      [&] { return crossings.counted() > 0 || goes_through(d); });
  cell.figure += fmt::format(", {} vertices through the plate", crossings.counted());
  if (!crossings.misses().empty()) {
    cell.verdict = Verdict::kSilent;
    cell.reason = crossings.misses();
  }
  return cell;
}

}  // namespace

Row impact_row() {
  Row row{
      "impact",
      "a thin slab thrown at 0.1 to 100 m/s (three times its wave speed) on a plane, and on an equally thin "
      "plate: tunnelled vertices are counted.  Detects bodies that are not reversed or that gain energy, and "
      "tunnelled vertices that are not reported"};
  const auto add = [&row](std::string name, const scene::Description& thrown,
                          StabilityCell (*run)(const CaseContext&, const scene::Description&)) {
    row.cases.push_back({std::move(name),
                         [thrown](const CaseContext& context) { return expect_thrown(context, thrown); },
                         [thrown, run](const CaseContext& context) { return run(context, thrown); }});
  };
  for (const double speed : {0.1, 1.0, 10.0, 100.0})
    add(fmt::format("{:g} m/s", speed), on_plane(speed), run_on_plane);
  for (const double speed : {0.1, 1.0, 10.0, 100.0})
    add(fmt::format("{:g} m/s on a thin plate", speed), on_plate(speed), run_on_plate);
  row.core = 1;
  return row;
}

}  // namespace palpate::stability
