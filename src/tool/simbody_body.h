#pragma once
#include "simbody/headers.h"

#include "handle_path.h"
#include "parameters.h"

namespace palpate::tool {

/// The tool's Simbody System: one MobilizedBody::Free under one force element that reads the tick's input
/// from the State. Its coordinates are ours: q = (qw qx qy qz px py pz), u = (angular, linear) in world axes,
/// origin at the centre of mass.
class SimbodyBody {
 public:
  explicit SimbodyBody(const RigidParameters& parameters);
  SimbodyBody(const SimbodyBody&) = delete;
  SimbodyBody& operator=(const SimbodyBody&) = delete;

  const RigidParameters& parameters() const { return parameters_; }
  const SimTK::MultibodySystem& system() const { return system_; }
  /// A State of the topology, for an integrator to start from.
  const SimTK::State& default_state() const { return state_; }

  void write(SimTK::State& state, double t, const RigidMotion& motion) const;
  RigidMotion read(const SimTK::State& state) const;
  void set_input(SimTK::State& state, const TickInput& input) const;

  /// u' at a time and motion under an input, by Simbody's forward dynamics (coupling, contact, gravity,
  /// gyroscopic terms).
  Vec6 acceleration(double t, const RigidMotion& motion, const TickInput& input);
  /// f of M u' = f: the same forces by Newton and Euler in closed form, for ticks that may take no memory
  /// (Simbody's forward dynamics takes some at each call).
  Vec6 right_hand_side(double t, const RigidMotion& motion, const TickInput& input) const;
  /// M of M u' = f at a pose, by Simbody's calcM.
  Mat6 calc_mass(const RigidMotion& motion);
  /// f without coupling and contact: gyroscopic forces and weight, which Simbody's inverse dynamics at u' = 0
  /// gives with the opposite sign.
  Vec6 calc_force(double t, const RigidMotion& motion);
  double calc_potential_energy(const RigidMotion& motion);  ///< of the weight [J]
  /// diag(R I R^T, m), world axes, angular first.
  Mat6 mass_matrix(const Pose& pose) const;

 private:
  bool is_somewhere(double t, const RigidMotion& motion);  ///< state_ realised there
  class TickForce;

  RigidParameters parameters_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::MobilizedBody::Free body_;
  TickForce* force_ = nullptr;     ///< owned by forces_
  SimTK::State state_;             ///< scratch
  SimTK::Matrix mass_;             ///< scratch
  SimTK::Vector zero_, residual_;  ///< scratch
};

}  // namespace palpate::tool
