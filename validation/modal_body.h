#pragma once
#include <functional>
#include <optional>

#include "palpate/fem/soft_body.h"
#include "palpate/modes/modes.h"

namespace palpate::validation {

/// What the library computes with instead of what it is asked: its defects, for the faults of cases.
struct ModalDefect {
  double force = 1.0, mass = 1.0, bone_mass = 1.0;  ///< factors
  std::optional<fem::Materials> elements, masses;   ///< other materials of the forces, of the masses
  std::vector<int> held;                            ///< directions of u that nobody asked to hold
};

/// One soft body at rest and its modes, for the cases of section D on frequencies.
struct ModalBody {
  TetMesh rest;
  fem::Material material;
  std::optional<fem::Materials> layers;  ///< instead of `material`
  bool consistent_mass = false;
  std::vector<int> held;     ///< directions of u, any order
  std::vector<int> carried;  ///< nodes that sit on a free rigid bone, ascending; empty: there is none
  double bone_mass = 0.0;    ///< [kg]
  Vec3 bone_inertia = Vec3::Zero(), bone_centre = Vec3::Zero();

  ModalDefect defect{};

  /// Holds the axes ("x", "yz") of every node that `where` is true for.
  void hold(const std::string& axes, const std::function<bool(const Vec3&)>& where);
  /// The lowest modes.  @throws Error where they do not converge
  modes::Modes lowest(int count) const;
  /// Mass-weighted overlap (f M g)^2 / ((f M f)(g M g)) of two fields, lumped; held directions count as they
  /// stand, a bone does not.
  double overlap(const VecX& f, const VecX& g) const;
  fem::Materials materials() const { return layers ? *layers : fem::Materials(material); }
  VecX field(const std::function<Vec3(const Vec3&)>& displacement) const;  ///< its values at the nodes
};

/// The mode with the largest overlap with a shape.
struct Match {
  int mode = -1;
  double overlap = 0.0, omega = 0.0;  ///< [rad/s]
};
Match best_match(const ModalBody& body, const modes::Modes& modes, const VecX& shape);

}  // namespace palpate::validation
