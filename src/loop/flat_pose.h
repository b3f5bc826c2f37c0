#pragma once
#include <array>

#include "palpate/core/pose.h"

namespace palpate::loop {

/// As LinearisedContact has it.
inline std::array<double, 7> flat(const Pose& pose) {
  return {pose.rotation.w(),    pose.rotation.x(),    pose.rotation.y(),   pose.rotation.z(),
          pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

}  // namespace palpate::loop
