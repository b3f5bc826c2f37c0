#pragma once
#include <numbers>

#include "surfaces.h"

/// Balls and rigid surfaces of frames against exact shapes.
namespace contact_tests::rigid_sides {

inline constexpr double kR = 0.3;  ///< radius of the balls

inline std::vector<contact::ContactSample> query(contact::SampleSource& source,
                                                 const dynamics::State& state) {
  std::vector<contact::ContactSample> samples;
  source.query(state.view(), samples);
  return samples;
}

inline std::unique_ptr<contact::SampleSource> on_plane(contact::ContactSide side, double candidate_gap) {
  return contact::make_plane_source(std::move(side), 1, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(),
                                    candidate_gap);
}

/// Volume of a ball's cap of height `depth`.
inline double cap(double depth) { return std::numbers::pi * depth * depth * (kR - depth / 3.0); }

}  // namespace contact_tests::rigid_sides
