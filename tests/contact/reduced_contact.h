#pragma once
#include "contact/reduced_contact_model.h"

/// Shared by the tests of the reduced contact model.
namespace contact_tests::reduced_contact {

using namespace palpate;

inline constexpr int kModes = contact::ReducedContactModel::kMostModes;

inline ContactSpec law(double friction = 0.0) {
  ContactSpec spec;
  spec.stiffness_pa_m = 1e6;
  spec.damping_pa_s_m = 1e2;
  spec.friction = friction;
  return spec;
}

}  // namespace contact_tests::reduced_contact
