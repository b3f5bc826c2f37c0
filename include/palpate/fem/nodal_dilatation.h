#pragma once
#include <memory>
#include <string>

#include "palpate/fem/soft_body.h"

namespace palpate::fem {

/// Share of lambda that a body with nodal dilatation keeps element by element: that of lambda_e = min(lambda,
/// mu), Poisson's ratio 1/4. An element of nu = 1/4 does not lock, and resists a change of volume that the
/// nodes' averages miss.  On the beam of the case `locking` (12 cells over its height) the tip is off by 1.0
/// % with nothing kept, 1.3 % with mu, 2.1 % with 4 mu. 1 where lambda <= mu: there is nothing left for
/// NodalDilatation then.
double kept_volumetric_share(const Material& material);

/// The rest of lambda by nodal averages of the dilatation (Bonet and Burton 1998; the kept share after Puso
/// and Solberg 2006): the remedy against volumetric locking for nu -> 0.5.  Elastic energy, objective damping
/// lambda_d and their tangents.  Couples nodes that share a neighbour:
/// about four times the blocks of the element's pattern, and a factor that costs accordingly.
///
/// Where a body has several materials, averages are taken within each, so that a soft one is not held by a
/// stiff one beside it.
///
/// Goes with a SoftBody of the same mesh, materials, options and block: together they are the body.
/// Limits: displacements converge for nu -> 0.5, pressures of single nodes may alternate around the true one
/// (equal orders of displacement and pressure): average them before reading.  Boundary nodes average over the
/// inside alone.
class NodalDilatation : public dynamics::ForceTerm, public dynamics::PsdProjectedTerm {
 public:
  /// @param name  of the term  @param rest, materials, block_id  those of the SoftBody
  /// @param options  of the SoftBody: 1 - share_of(material) of lambda acts here; both tangent settings act
  ///   as there
  NodalDilatation(std::string name, const TetMesh& rest, const Materials& materials,
                  const SoftBodyOptions& options, int block_id);
  ~NodalDilatation() override;

  std::string_view name() const override;
  void project_to_psd(bool on) override;
  dynamics::TermTraits traits() const override;
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override;
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override;
  double energy(const dynamics::StateView& state) override;
  double dissipated_power(const dynamics::StateView& state) override;

  void set_materials(const std::vector<Material>& materials);  ///< as SoftBody::set_materials
  /// theta_n of each node; where materials meet, the average over them by volume.
  VecX dilatations(const dynamics::StateView& state);
  /// Von Mises norm of the whole body's Cauchy stress (SoftBody::nodal_stress with the pressure that acts
  /// here) [Pa].
  VecX nodal_stress(const dynamics::StateView& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
