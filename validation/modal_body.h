#pragma once
#include <functional>
#include <optional>

#include "palpate/fem/soft_body.h"
#include "palpate/modes/modes.h"

namespace palpate::validation {

/// Defects for the faults of cases: differences between the library's computation and the case's request.
struct ModalDefect {
  double force = 1.0, mass = 1.0, bone_mass = 1.0;  ///< Factors.
  std::optional<fem::Materials> elements, masses;   ///< Other materials for the forces and for the masses.
  std::vector<int> held;                            ///< Directions of u held although not requested.
};

/// Soft body at rest and its modes, for the cases of section D on frequencies.
struct ModalBody {
  TetMesh rest;
  fem::Material material;
  std::optional<fem::Materials> layers;  ///< Used instead of `material`.
  bool consistent_mass = false;
  std::vector<int> held;     ///< Directions of u, in any order.
  std::vector<int> carried;  ///< Nodes attached to a free rigid bone, ascending; empty: no bone.
  double bone_mass = 0.0;    ///< [kg]
  Vec3 bone_inertia = Vec3::Zero(), bone_centre = Vec3::Zero();

  ModalDefect defect{};

  /// Holds the axes ("x", "yz") of every node for which `where` is true.
  void hold(const std::string& axes, const std::function<bool(const Vec3&)>& where);
  /// Returns the lowest modes. @throws Error if they do not converge
  modes::Modes lowest(int count) const;
  /// Returns the mass-weighted overlap (f M g)^2 / ((f M f)(g M g)) of two fields, with lumped masses. Held
  /// directions are included unchanged, a bone is not.
  double overlap(const VecX& f, const VecX& g) const;
  fem::Materials materials() const { return layers ? *layers : fem::Materials(material); }
  VecX field(const std::function<Vec3(const Vec3&)>& displacement) const;  ///< Values at the nodes.
};

/// Mode with the largest overlap with a shape.
struct Match {
  int mode = -1;
  double overlap = 0.0, omega = 0.0;  ///< [rad/s]
};
Match best_match(const ModalBody& body, const modes::Modes& modes, const VecX& shape);

}  // namespace palpate::validation
