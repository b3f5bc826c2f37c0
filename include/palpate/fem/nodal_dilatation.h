#pragma once
#include <memory>
#include <string>

#include "palpate/fem/soft_body.h"

namespace palpate::fem {

/// Returns the share of lambda that a body with nodal dilatation keeps in its elements: the share of
/// lambda_e = min(lambda, mu), which is Poisson's ratio 1/4. An element of nu = 1/4 does not lock, and it
/// resists volume changes that cancel in the nodal averages. On the beam of the case `locking` (12 cells over
/// its height) the error of the tip is 1.0 % with nothing kept, 1.3 % with mu, 2.1 % with 4 mu. The share is
/// 1 where lambda <= mu: nothing is left for NodalDilatation then.
double kept_volumetric_share(const Material& material);

/// Force term of the remaining share of lambda, by nodal averages of the dilatation (Bonet and Burton 1998;
/// the share kept in elements after Puso and Solberg 2006): the remedy against volumetric locking for
/// nu -> 0.5. Includes elastic energy, objective damping lambda_d and their tangents. It couples nodes that
/// share a neighbour: about four times as many blocks as the element pattern, with a correspondingly more
/// expensive factor.
///
/// In a body of several materials, averages are taken within each material, so that a soft material is not
/// constrained by an adjacent stiff one.
///
/// Use it together with a SoftBody of the same mesh, materials, options and block: the two form the body.
/// Limits: displacements converge for nu -> 0.5, but pressures of single nodes may alternate around the true
/// pressure (equal orders of displacement and pressure): average them before use. Boundary nodes average over
/// the interior side only.
class NodalDilatation : public dynamics::ForceTerm, public dynamics::PsdProjectedTerm {
 public:
  /// @param name  Name of the term, in messages and reports.
  /// @param rest, materials, block_id  As for the SoftBody.
  /// @param options  As for the SoftBody: the share 1 - share_of(material) of lambda acts here; both tangent
  ///   settings apply as there.
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
  /// Returns the averaged dilatation theta_n of each node; where materials meet, the mean by volume.
  VecX dilatations(const dynamics::StateView& state);
  /// Returns the von Mises norm of the whole body's Cauchy stress per node [Pa]: SoftBody::nodal_stress
  /// including the pressure of this term.
  VecX nodal_stress(const dynamics::StateView& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
