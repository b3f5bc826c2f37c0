#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

// Two blocks of one material, one on the other, whose meshes do not match, in a smooth rigid box: sides do
// not move outwards, the lower bottom is held, the upper top is pushed down by D.  Every horizontal cut
// carries the same pressure, and strain is uniform in each block: three springs in series,
//     p = D/(H1/M + H2/M + 1/k),    M = lambda + 2 mu   (small strain; R = I),
// with the contact's k between them.
//
// A contact passes this patch test when the pressure that acts on the nodes of either side is what a uniform
// pressure gives, the integral of the shape functions: so for samples that fill the area, each at its own
// place on both faces.  `vertex` samples give each node of one side its share of that side's area, but put it
// on the other where the vertex happens to be.
//
// The lower block is wider by 1e-5: of vertices at a common rim rounding, and the region's normal, which is
// that of the deformed faces, would say which have a face opposite.  So all vertices of the upper block's
// lower face are samples, and of the lower block those inside its rim; the strip that carries nothing costs
// 1e-5 of the pressure.

namespace palpate::validation {
namespace {

constexpr double kWider = 1.0 + 1e-5;
const Vec3 kLower(0.03 * kWider, 0.03 * kWider, 0.02), kUpper(0.03, 0.03, 0.015);
const std::array<int, 3> kLowerCells{5, 4, 3}, kUpperCells{4, 6, 2};
constexpr int kVertices = (4 + 1) * (6 + 1) + (5 - 1) * (4 - 1);  // that are samples
constexpr double kPush = 1e-4;

struct Block {
  TetMesh rest;
  int block_id = -1;
  contact::NodeSurface surface;
};

/// The mesh's own lines bent in the plane, so that no triangle of one side lies along one of the other.
TetMesh bent_box(const Vec3& size, const std::array<int, 3>& cells, double bend) {
  TetMesh mesh = mesh::box(size, cells);
  for (auto x : mesh.nodes.colwise()) {
    const double u = 2.0 * x.x() / size.x(), v = 2.0 * x.y() / size.y();
    x.x() += bend * size.x() * (1.0 - u * u) * (0.5 + v);
    x.y() -= bend * size.y() * (1.0 - v * v) * (0.3 - u);
  }
  return mesh;
}

struct Pressed {
  double pressure = std::nan("");   ///< of the contact, mean [Pa]
  double deviation = std::nan("");  ///< largest, of an element's stress from the exact one, over it
  std::size_t samples = 0;
};

/// -P_zz of each element [Pa], at small strain.
double largest_deviation(const TetMesh& rest, const double* q, const fem::Material& material, double exact) {
  double largest = 0.0;
  for (const auto& tet : rest.tets.colwise()) {
    Mat3 before, after;
    for (int a = 0; a < 3; ++a) {
      const auto at = [&](int node) { return Vec3(q[3 * node], q[3 * node + 1], q[3 * node + 2]); };
      before.col(a) = rest.nodes.col(tet[a + 1]) - rest.nodes.col(tet[0]);
      after.col(a) = at(tet[a + 1]) - at(tet[0]);
    }
    const Mat3 F = after * before.inverse(), strain = 0.5 * (F + F.transpose()) - Mat3::Identity();
    const double stress = material.lambda() * strain.trace() + 2.0 * material.mu() * strain(2, 2);
    largest = std::max(largest, std::abs(-stress / exact - 1.0));
  }
  return largest;
}

Pressed press(contact::DepthBackend backend, contact::SampleRule samples, const std::string& fault) {
  fem::Material material;
  const double modulus = material.lambda() + 2.0 * material.mu(), stiffness = 2.0 * modulus / kLower.z(),
               exact = kPush / ((kLower.z() + kUpper.z()) / modulus + 1.0 / stiffness);
  dynamics::State state;
  dynamics::System system;
  std::vector<Block> blocks(2);
  blocks[0].rest = bent_box(kLower, kLowerCells, 0.03);
  blocks[1].rest = bent_box(kUpper, kUpperCells, -0.04);
  blocks[0].rest.nodes.row(2).array() -= 0.5 * kLower.z();
  blocks[1].rest.nodes.row(2).array() += 0.5 * kUpper.z();
  std::vector<int> held;
  for (int b = 0; b < 2; ++b) {
    Block& block = blocks[static_cast<std::size_t>(b)];
    const Vec3& size = b == 0 ? kLower : kUpper;
    VecX q = block.rest.nodes.reshaped();
    const int first = state.layout().u_size;
    for (int i = 0; i < block.rest.nodes.cols(); ++i) {
      const Vec3 x = block.rest.nodes.col(i);
      for (int axis : {0, 1})
        if (std::abs(std::abs(x[axis]) - 0.5 * size[axis]) < 1e-9) held.push_back(first + 3 * i + axis);
      if (b == 1) q[3 * i + 2] -= kPush;
      if (b == 0 ? x.z() < 1e-9 - size.z() : x.z() > size.z() - 1e-9) held.push_back(first + 3 * i + 2);
    }
    dynamics::BlockSpec nodes;
    nodes.name = b == 0 ? "lower" : "upper";
    nodes.q_size = nodes.u_size = static_cast<int>(q.size());
    block.block_id = state.insert(nodes, q, VecX::Zero(q.size()));
    system.add(std::make_shared<fem::SoftBody>(nodes.name, block.rest, material, fem::SoftBodyOptions{},
                                               block.block_id));
    system.add(fem::make_lumped_mass(block.rest, material, block.block_id));
    const mesh::Boundary boundary = mesh::boundary(block.rest);
    block.surface = {block.block_id, boundary.node_of_vertex, boundary.surface.faces};
  }
  std::sort(held.begin(), held.end());
  system.add(fem::make_fixed(held, VecX(state.q()(held))));

  contact::ImageOptions options;
  options.backend = backend;
  options.pixels = 256;
  options.samples = samples;
  options.candidate_gap = 0.1 * kPush;
  auto source = contact::make_image_source(blocks[1].surface, blocks[0].surface, options);
  // (on the nearest corner it would pass: each has a third of its triangle)
  if (fault == "force-on-first-corner")
    source = spoiled(std::move(source), [](auto& all) {
      for (auto& s : all) {
        s.b.weight = {1.0, 0.0, 0.0, 0.0};
        s.b.count = 1;
      }
    });
  if (fault == "samples-lost")
    source = spoiled(std::move(source), [](auto& all) {
      std::size_t i = 0;
      std::erase_if(all, [&](const auto&) { return ++i % 5 == 0; });
    });
  if (fault == "half-area")
    source = spoiled(std::move(source), [](auto& all) {
      for (auto& s : all) s.area *= 0.5;
    });
  const auto contact = std::make_shared<contact::ContactForce>();
  ContactSpec law;
  law.stiffness_pa_m = stiffness;
  contact->add_pair(std::move(source), law);
  system.add(std::static_pointer_cast<dynamics::ForceTerm>(contact));
  IntegratorSpec spec;
  spec.name = "kinsol-static";
  spec.newton_rtol = 1e-10;
  for (int query = 0; query < 3; ++query) {
    contact->refresh(state.view());
    system.prepare(state.view());
    if (!integrate::make_stepper(system, state, spec)->advance_to(state.time() + 1.0).ok()) return {};
  }
  Pressed out;
  VecX f = VecX::Zero(state.layout().u_size);
  contact->add_force(state.view(), f);
  const dynamics::Block& upper = *state.layout().find(blocks[1].block_id);
  double force = 0.0;
  for (int i = 0; i < upper.u_size; i += 3) force += f[upper.u_offset + i + 2];
  out.pressure = force / (kUpper.x() * kUpper.y());
  out.samples = contact->samples().size();
  out.deviation = 0.0;
  for (const Block& block : blocks)
    out.deviation = std::max(
        out.deviation,
        largest_deviation(block.rest, state.q().data() + state.layout().find(block.block_id)->q_offset,
                          material, exact));
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  fem::Material material;
  const double modulus = material.lambda() + 2.0 * material.mu(), stiffness = 2.0 * modulus / kLower.z(),
               exact = kPush / ((kLower.z() + kUpper.z()) / modulus + 1.0 / stiffness);
  std::vector<Measurement> out;
  double first = std::nan("");
  for (const contact::DepthBackend backend : image_backends(fault)) {
    const std::string name(contact::backend_name(backend));
    const Pressed pixel = press(backend, contact::SampleRule::kPixel, fault);
    out.push_back({.quantity = name + ", pixel: mean pressure of the contact [Pa]",
                   .computed = pixel.pressure,
                   .exact = exact,
                   .error = std::abs(pixel.pressure / exact - 1.0),
                   .bar = 1e-2});
    out.push_back({.quantity = name + ", pixel: largest error of an element's stress / the stress",
                   .computed = pixel.deviation,
                   .error = pixel.deviation,
                   .bar = 1e-2});
    if (!fault.empty() && fault != "samples-lost") continue;
    const Pressed vertex = press(backend, contact::SampleRule::kVertex, fault);
    out.push_back({.quantity = name + ", vertex: samples [count]",
                   .computed = static_cast<double>(vertex.samples),
                   .exact = kVertices,
                   .error = std::abs(static_cast<double>(vertex.samples) / kVertices - 1.0)});
    out.push_back({.quantity = name + ", vertex: largest error of an element's stress / the stress",
                   .computed = vertex.deviation,
                   .error = vertex.deviation,
                   .bar = std::numeric_limits<double>::infinity(),
                   .note = "reported, not barred: vertices do not pass the patch test"});
    if (std::isnan(first)) {
      first = vertex.deviation;
      continue;
    }
    out.push_back({.quantity = name + ", vertex: that figure against the first backend's",
                   .computed = vertex.deviation,
                   .exact = first,
                   .error = std::abs(vertex.deviation / first - 1.0),
                   .bar = 1e-9});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase contact_patch() {
  return {.name = "contact-patch",
          .section = "C",
          .summary = "two blocks with meshes that do not match, pressed together: the stress stays uniform",
          .why =
              "whether meshes that do not match pass on a uniform pressure decides whether contact converges "
              "with the mesh (the contact patch test, Taylor and Papadopoulos 1991)",
          .quick = true,
          .run = run,
          .faults = {{"force-on-first-corner", "pixel: largest error"},
                     {"half-area", "pixel: mean pressure"},
                     {"samples-lost", "vertex: samples"}}};
}

}  // namespace palpate::validation
