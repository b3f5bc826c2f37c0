#pragma once
#include "render/colour_map.h"
#include "session/world_snapshot.h"

namespace palpate::session {

/// Returns the values of a body at the vertices of its surface; NaN: no value there.
VecX surface_values(const loop::World& world, std::size_t body, const WorldSnapshot& snapshot, Shade shade);

/// Returns the largest value of all bodies at a snapshot; 0 if there is none.
double largest_value(const loop::World& world, const WorldSnapshot& snapshot, Shade shade);

/// Returns the colour scale of a shade, from 0 up to a rounded range. Differences below its resolution are
/// rounding: a billionth of the size of the scene for positions, a billionth of the largest Young's modulus
/// for stress.
/// @param extent   size of the scene [m]
/// @param largest  largest value to be shown
render::ColourScale colour_scale(const loop::World& world, Shade shade, double extent, double largest);

/// Observer that finds the largest value of a whole run, so that its picture and its movie have one range of
/// colours.
class LargestValue : public loop::Observer {
 public:
  explicit LargestValue(Shade shade) : shade_(shade) {}
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  double value() const { return largest_; }

 private:
  void add(loop::World& world, double t);
  Shade shade_;
  double largest_ = 0.0;
};

}  // namespace palpate::session
