#pragma once
#include <Eigen/LU>

#include "../../src/fem/law.h"
#include "../../src/fem/objective_damping.h"
#include "fem_fixture.h"
#include "palpate/fem/laws.h"

// Fast path of a SoftBody against the scalar formulas of its law.

namespace palpate::fem::testing {

inline const Law& law_called(const std::string& name) { return *find(law_registry(), name, "material").make; }

/// Instruction sets of this build that the processor supports; always includes baseline.
inline std::vector<std::string> instruction_sets() {
  std::vector<std::string> out;
  for (const char* name : {"baseline", "avx2", "avx512"})
    if (message_of([&] { SoftBody("b", one_tet(), soft_material(), {.instructions = name}, 0); }).empty())
      out.emplace_back(name);
  return out;
}

inline Material damped_material() {
  Material m = soft_material();
  m.stiffness_damping = 0.4;
  m.mass_damping = 0.3;
  return m;
}

inline SoftBodyOptions options(Tangent tangent, bool full, const std::string& instructions) {
  SoftBodyOptions out;
  out.tangent = tangent;
  out.full_damping_tangent = full;
  out.instructions = instructions;
  return out;
}

struct Evaluation {
  VecX f, y;
  MatX A;
  std::vector<double> values;
  double energy = 0.0, power = 0.0;
  ElementCounts counts;
};

inline Evaluation evaluate(const TetMesh& rest, const Material& material, const SoftBodyOptions& options,
                           const VecX& x, const VecX& v, const VecX& w, bool dense) {
  OneBody at(x, v);
  SoftBody body("b", rest, material, options, at.id);
  dynamics::PatternBuilder builder(at.state.layout());
  body.add_pattern(builder);
  dynamics::BorderedMatrix A;
  A.body = builder.build();
  Evaluation out;
  out.f = out.y = VecX::Zero(x.size());
  body.add_force(at.state.view(), out.f);
  body.add_tangent(at.state.view(), 0.7, 1.9, A);
  out.counts = body.counts();
  body.apply_tangent(at.state.view(), 0.7, 1.9, w, out.y);
  out.energy = body.energy(at.state.view());
  out.power = body.dissipated_power(at.state.view());
  out.values = A.body.values();
  if (dense) out.A = A.to_dense();
  return out;
}

/// Results of a SoftBody, element by element, by the scalar formulas of its law and damping.
struct Reference {
  VecX f, y;
  double energy = 0.0, power = 0.0;
};
inline Reference reference(const Law& law, const TetMesh& rest, const Material& material, Tangent tangent,
                           bool by_position, const VecX& x, const VecX& v, const VecX& w) {
  const Lame elastic{material.mu(), material.lambda()};
  const Lame damping{material.stiffness_damping * material.mu(),
                     material.stiffness_damping * material.lambda()};
  Reference out;
  out.f = out.y = VecX::Zero(x.size());
  for (Eigen::Index e = 0; e < rest.tets.cols(); ++e) {
    const auto tet = rest.tets.col(e);
    const auto edges = [&](const VecX& field) {
      Mat3 m;
      for (int a = 0; a < 3; ++a) m.col(a) = field.segment<3>(3 * tet[a + 1]) - field.segment<3>(3 * tet[0]);
      return m;
    };
    const Mat3 Dm = edges(flat(rest.nodes)), gradients = Dm.inverse();
    const double V = Dm.determinant() / 6.0;
    const Mat3 F = edges(x) * gradients, F_dot = edges(v) * gradients, dF = edges(w) * gradients;
    const Mat3 P = law.stress(F, elastic) + F * damping_stress(strain_rate(F, F_dot), damping);
    Mat3 dP = 0.7 * law.stress_change(tangent, F, dF, elastic) +
              1.9 * F * damping_stress(strain_rate(F, dF), damping);
    if (by_position)
      dP += 0.7 * (dF * damping_stress(strain_rate(F, F_dot), damping) +
                   F * damping_stress(strain_rate(dF, F_dot), damping));
    for (int a = 0; a < 4; ++a) {
      const Vec3 g =
          a == 0 ? Vec3(-gradients.colwise().sum().transpose()) : Vec3(gradients.row(a - 1).transpose());
      const double mass_damping = material.mass_damping * material.density * 0.25 * V;
      out.f.segment<3>(3 * tet[a]) -= V * P * g + mass_damping * v.segment<3>(3 * tet[a]);
      out.y.segment<3>(3 * tet[a]) += V * dP * g + 1.9 * mass_damping * w.segment<3>(3 * tet[a]);
      out.power += mass_damping * v.segment<3>(3 * tet[a]).squaredNorm();
    }
    out.energy += V * law.energy_density(F, elastic);
    out.power += V * strain_rate(F, F_dot).cwiseProduct(damping_stress(strain_rate(F, F_dot), damping)).sum();
  }
  return out;
}

/// Separate tetrahedra, each with its deformation.
struct Apart {
  TetMesh rest;
  VecX x, v, w;
  Apart(const std::vector<Mat3>& deformations, Random& random) {
    const auto count = static_cast<Eigen::Index>(deformations.size());
    rest.nodes.resize(3, 4 * count);
    rest.tets.resize(4, count);
    x.resize(12 * count);
    for (Eigen::Index e = 0; e < count; ++e) {
      rest.nodes.middleCols(4 * e, 4) = one_tet().nodes;
      for (int a = 0; a < 4; ++a) rest.tets(a, e) = static_cast<int>(4 * e) + a;
      x.segment<12>(12 * e) = flat(deformations[static_cast<std::size_t>(e)] * one_tet().nodes);
    }
    v = random.vector(x.size());
    w = random.vector(x.size());
  }
};

/// Relative distance between two vectors.
inline double apart(const VecX& a, const VecX& b) { return (a - b).norm() / b.norm(); }

}  // namespace palpate::fem::testing
