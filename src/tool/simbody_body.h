#pragma once
#include "simbody/headers.h"

#include "parameters.h"
#include "tick_input.h"

namespace palpate::tool {

/// Simbody System of the tool: one MobilizedBody::Free under one force element that reads the tick's input
/// from the State. Coordinates match ours: q = (qw qx qy qz px py pz), u = (angular, linear) in world axes,
/// origin at the centre of mass.
class SimbodyBody {
 public:
  explicit SimbodyBody(const RigidParameters& parameters);
  SimbodyBody(const SimbodyBody&) = delete;
  SimbodyBody& operator=(const SimbodyBody&) = delete;

  const RigidParameters& parameters() const { return parameters_; }
  const SimTK::MultibodySystem& system() const { return system_; }
  /// Returns a State with topology and model realised, as an integrator's initial state.
  const SimTK::State& default_state() const { return state_; }

  /// Copies time and motion into a State, and back; `set_input` copies the tick's input.
  void write(SimTK::State& state, double t, const RigidMotion& motion) const;
  RigidMotion read(const SimTK::State& state) const;
  void set_input(SimTK::State& state, const TickInput& input) const;

  /// Returns u' at a time and motion under an input, by Simbody's forward dynamics (coupling, contact,
  /// gravity, gyroscopic terms).
  Vec6 acceleration(double t, const RigidMotion& motion, const TickInput& input);
  /// Returns f of M u' = f: the same forces by the Newton-Euler equations in closed form, for ticks that must
  /// not allocate (Simbody's forward dynamics allocates in each call).
  Vec6 right_hand_side(double t, const RigidMotion& motion, const TickInput& input) const;
  /// Returns M of M u' = f at a pose, by Simbody's calcM. NaN if Simbody cannot realise the motion.
  Mat6 calc_mass(const RigidMotion& motion);
  /// Returns f without coupling and contact: gyroscopic forces and weight, which are minus Simbody's inverse
  /// dynamics at u' = 0. NaN if Simbody cannot realise the motion.
  Vec6 calc_force(double t, const RigidMotion& motion);
  double calc_potential_energy(const RigidMotion& motion);  ///< Weight [J].
  /// Returns diag(R I R^T, m), world axes, angular first.
  Mat6 mass_matrix(const Pose& pose) const;

 private:
  bool is_somewhere(double t, const RigidMotion& motion);  ///< Realises state_; false if Simbody throws.
  class TickForce;

  RigidParameters parameters_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::MobilizedBody::Free body_;
  TickForce* force_ = nullptr;     ///< Owned by forces_.
  SimTK::State state_;             ///< Scratch.
  SimTK::Matrix mass_;             ///< Scratch.
  SimTK::Vector zero_, residual_;  ///< Scratch.
};

}  // namespace palpate::tool
