#pragma once
#include <string>

#include "palpate/scene/description.h"

namespace palpate::loop {

/// Choice for exchange.scheme = "auto".
struct SchemeChoice {
  scene::ExchangeScheme scheme = scene::ExchangeScheme::kPartitioned;
  double step_s = 0.0;  ///< Median wall time of one step of the single-rate scheme [s].
  double tick_s = 0.0;  ///< Length of a tick [s].
  /// Returns the choice and its reason, one line.
  std::string text() const;
};

/// Measures steps of the single-rate scheme from the start of the scene, with the hands at rest, and chooses
/// that scheme where a step takes at most half a tick, otherwise the partitioned one. The other half is for
/// contact, which the start may not have, and for what else the machine does. The choice depends on the
/// machine; a run stores it in its scene.toml.
/// @pre the scene has a tool
/// @throws Error as assemble()
SchemeChoice choose_scheme(const scene::Description& description);

/// Returns the scene with a scheme, in its text as well, where it has one.
scene::Description with_scheme(const scene::Description& description, scene::ExchangeScheme scheme);

}  // namespace palpate::loop
