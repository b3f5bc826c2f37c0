#pragma once
#include <array>

#include "palpate/core/pose.h"

namespace palpate::loop {

/// Returns (qw qx qy qz px py pz), as in LinearisedContact.
inline std::array<double, 7> flat(const Pose& pose) {
  return {pose.rotation.w(),    pose.rotation.x(),    pose.rotation.y(),   pose.rotation.z(),
          pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

}  // namespace palpate::loop
