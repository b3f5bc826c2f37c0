#pragma once
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

/// Factories of the integrators listed in registry.cpp.
namespace palpate::integrate {

std::unique_ptr<dynamics::Stepper> make_cvode(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                              std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_ark(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                            std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_mri(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                            std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_ida(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                            std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_kinsol_static(dynamics::System&, dynamics::State&,
                                                      const IntegratorSpec&,
                                                      std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_linearly_implicit_euler(dynamics::System&, dynamics::State&,
                                                                const IntegratorSpec&,
                                                                std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_linearly_implicit_bdf2(dynamics::System&, dynamics::State&,
                                                               const IntegratorSpec&,
                                                               std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_backward_euler(dynamics::System&, dynamics::State&,
                                                       const IntegratorSpec&,
                                                       std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_implicit_midpoint(dynamics::System&, dynamics::State&,
                                                          const IntegratorSpec&,
                                                          std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_bdf2(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                             std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_newmark(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                                std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_generalized_alpha(dynamics::System&, dynamics::State&,
                                                          const IntegratorSpec&,
                                                          std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_symplectic_euler(dynamics::System&, dynamics::State&,
                                                         const IntegratorSpec&,
                                                         std::unique_ptr<dynamics::LinearSolver>);
std::unique_ptr<dynamics::Stepper> make_rk4(dynamics::System&, dynamics::State&, const IntegratorSpec&,
                                            std::unique_ptr<dynamics::LinearSolver>);

}  // namespace palpate::integrate
