#include "cpodes.h"

#include <Simbody.h>

double cpodes_decay(double t) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  const SimTK::Body::Rigid mass(SimTK::MassProperties(1.0, SimTK::Vec3(0), SimTK::Inertia(1.0)));
  SimTK::MobilizedBody::Slider slider(matter.Ground(), mass);
  SimTK::Force::MobilityLinearDamper(forces, slider, SimTK::MobilizerUIndex(0), 1.0);
  SimTK::State state = system.realizeTopology();
  slider.setOneU(state, SimTK::MobilizerUIndex(0), 1.0);
  SimTK::CPodesIntegrator integrator(system);
  integrator.setAccuracy(1e-8);
  integrator.setFinalTime(t);
  integrator.initialize(state);
  while (integrator.getTime() < t) integrator.stepTo(t);
  return slider.getOneU(integrator.getState(), 0);
}
