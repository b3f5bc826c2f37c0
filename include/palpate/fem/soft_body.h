#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/dynamics/psd_projection.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/dynamics/stored_tangent.h"
#include "palpate/fem/material.h"
#include "palpate/fem/options.h"
#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Counts of special cases in element evaluations since the last reset, for reports.
struct ElementCounts {
  long inverted = 0;  ///< det F <= 0
  long clamped = 0;   ///< exact tangents near the singular set (two signed singular values cancel)
  /// Lanes that were computed one by one: close to the singular set, or in need of eigenvalues (projected
  /// tangent).
  long by_scalar = 0;
};

/// Memory of a body [bytes].
struct MemoryUse {
  std::size_t elements = 0;  ///< rest shapes, topology, chunks
  std::size_t maps = 0;      ///< maps into the matrix pattern
  std::size_t scratch = 0;   ///< work memory of all threads, and sums shared by chunks
};

/// Force term of linear tetrahedra with one constitutive law (laws.h) on one node block: elastic force,
/// objective stiffness damping, their tangents, energy. Mass-proportional damping is included (it needs the
/// lumped masses): f = -alpha M v; for several materials f_i = -c_i v_i, c_i = sum (alpha rho V / 4) over the
/// elements at node i. Materials belong to elements: where two meet, they share nodes and displacements, and
/// the traction is continuous as far as the mesh resolves it. Elements are evaluated in SIMD lanes and on the
/// worker threads of core (core/workers.h); results do not depend on the number of threads.
class SoftBody : public dynamics::ForceTerm,
                 public dynamics::StoredTangentTerm,
                 public dynamics::FusedStepTerm,
                 public dynamics::PsdProjectedTerm {
 public:
  /// @param name  Name of the term, in messages and reports.
  /// @param rest  Rest positions and tetrahedra, volumes positive.
  /// @param materials  Materials of the elements.
  /// @param options  Options of the evaluation.
  /// @param block_id  Node block in the State.
  SoftBody(std::string name, const TetMesh& rest, const Materials& materials, const SoftBodyOptions& options,
           int block_id);
  ~SoftBody() override;

  std::string_view name() const override;
  /// Switches to the projected tangent (symmetric, positive semi-definite) in place of the tangent in the
  /// options.
  void project_to_psd(bool on) override;
  /// Reports the element with the smallest det F <= 0.
  dynamics::Diagnostic inspect(const dynamics::StateView& state) const override;
  long clamped_tangents() const override { return counts().clamped; }
  dynamics::TermTraits traits() const override;
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override;
  int stored_block() const override;
  void store_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                     dynamics::BorderedMatrix& A) override;
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override;
  bool fuses_step() const override;
  std::uint64_t step_version() const override;
  void add_step_force_at_rate(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                              double rate, VecX& f) override;
  void add_step_force(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                      VecX& f) override;
  void add_step(const dynamics::StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                dynamics::ZeroRowSumMatrix& A) override;
  double energy(const dynamics::StateView& state) override;
  double dissipated_power(const dynamics::StateView& state) override;

  /// Returns the counts since the last reset_counts().
  const ElementCounts& counts() const;
  /// Sets all counts to zero.
  void reset_counts();
  const std::vector<Material>& materials() const;  ///< list of materials, as set
  /// Replaces the materials, as many as before; they take effect at the next evaluation. The assignment of
  /// elements to materials does not change.
  void set_materials(const std::vector<Material>& materials);
  /// Number of nodes of the mesh.
  int node_count() const;
  /// Number of tetrahedra of the mesh.
  int element_count() const;
  /// Returns the name of the instruction set in use.
  std::string_view instructions() const;
  /// Returns the memory currently in use.
  MemoryUse memory() const;
  /// Returns the von Mises norm of the element Cauchy stress, averaged to nodes by volume [Pa]; size
  /// node_count (for pictures and records).
  VecX nodal_stress(const dynamics::StateView& state) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the nodal masses [kg] of a mesh, one per node: rho V / 4 from each tetrahedron.
VecX lumped_masses(const TetMesh& rest, double density);
/// Returns the nodal masses [kg] with the density of each tetrahedron's material.
VecX lumped_masses(const TetMesh& rest, const Materials& materials);

/// Builds the lumped mass (lumped_masses()) of one node block.
std::shared_ptr<dynamics::InertiaTerm> make_lumped_mass(const TetMesh& rest, double density, int block_id);
/// Builds the lumped mass of one node block, with the density of each tetrahedron's material.
std::shared_ptr<dynamics::InertiaTerm> make_lumped_mass(const TetMesh& rest, const Materials& materials,
                                                        int block_id);
/// Builds the consistent mass of one node block, the integral of rho N_i N_j: rho V / 10 on the diagonal and
/// rho V / 20 off the diagonal, from each tetrahedron.
std::shared_ptr<dynamics::InertiaTerm> make_consistent_mass(const TetMesh& rest, double density,
                                                            int block_id);
/// Builds the consistent mass of one node block, with the density of each tetrahedron's material.
std::shared_ptr<dynamics::InertiaTerm> make_consistent_mass(const TetMesh& rest, const Materials& materials,
                                                            int block_id);

/// Builds the weight f_i = m_i g of a node block (lumped; equal to the consistent load of a constant field).
std::shared_ptr<dynamics::ForceTerm> make_gravity(const VecX& masses, const Vec3& gravity, int block_id);

/// Builds a dead load: a constant force on each node, 3 x node_count [N].
std::shared_ptr<dynamics::ForceTerm> make_dead_load(std::string name, const Points& forces, int block_id);

}  // namespace palpate::fem
